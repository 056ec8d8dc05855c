#pragma once

namespace hardbody::python {

/// Makes Python exceptions of the program's: InputError becomes ValueError, WriteError OSError; and MemoryError, with a
/// message, of std::bad_alloc. Messages are Unicode whatever they quote.
void register_exceptions();

}  // namespace hardbody::python
