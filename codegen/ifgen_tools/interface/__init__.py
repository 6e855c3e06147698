"""`ifgen interface`: the interfaces that can be found here. It needs no running system."""
