#pragma once

namespace hardbody::python {

/// Makes Python exceptions of the program's: InputError becomes ValueError, WriteError OSError.
void register_exceptions();

}  // namespace hardbody::python
