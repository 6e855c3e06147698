"""The text of interfaces: grammars of their files, trees and comments; `omg_...` is for .idl files."""
