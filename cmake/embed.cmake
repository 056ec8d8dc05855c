# Writes C++ functions that return the bytes of files:
# cmake -DOUTPUT=x.cpp -DHEADER=header -DNAMES=name,.. -Dname=file.. -P embed.cmake, for the names that the header declares.
set(text "#include \"${HEADER}\"\n\nnamespace hardbody {\n")
string(REPLACE "," ";" NAMES "${NAMES}")
foreach(name IN LISTS NAMES)
  file(READ ${${name}} bytes HEX)
  string(LENGTH "${bytes}" digits)
  math(EXPR size "${digits} / 2")
  string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
  string(APPEND text "std::string_view ${name}() { return {\"${bytes}\", ${size}}; }\n")
endforeach()
file(WRITE ${OUTPUT} "${text}}  // namespace hardbody\n")
