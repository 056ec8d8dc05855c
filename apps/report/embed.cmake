# Writes C++ functions that return the bytes of files: cmake -DOUTPUT=x.cpp -Dname=file... -P embed.cmake, for the names
# that report/assets.h declares.
set(text "#include \"report/assets.h\"\n\nnamespace hardbody {\n")
foreach(name report_script report_style report_static_style)
  file(READ ${${name}} bytes HEX)
  string(LENGTH "${bytes}" digits)
  math(EXPR size "${digits} / 2")
  string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
  string(APPEND text "std::string_view ${name}() { return {\"${bytes}\", ${size}}; }\n")
endforeach()
file(WRITE ${OUTPUT} "${text}}  // namespace hardbody\n")
