"""What was written: grammars of interface files, their trees and comments; `omg_...` is for .idl files."""
