# What the object files of the batch kernels offer to the linker: their own function, and no weak definition.
#
# An inline function or template that a translation unit compiled for AVX-512 defines is weak, and the linker may take
# it for all others: the program would then die on processors without AVX-512. Whatever lies in Highway's namespace of
# the instruction set (hwy::N_AVX2, ...) cannot be mistaken for anything else.
#
#   cmake -DNM=nm -DOWN=<name> "-DOBJECTS=a.o;b.o" -P kernel_symbols.cmake
#
# OWN: what the mangled names of their own functions begin with.
set(failed FALSE)
foreach(object IN LISTS OBJECTS)
  get_filename_component(name ${object} NAME)
  execute_process(COMMAND ${NM} ${object} OUTPUT_VARIABLE symbols RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${NM} ${object} failed")
  endif()
  string(REGEX MATCHALL "[0-9a-f]+ [A-Za-z] [^\n]+" symbols "${symbols}")
  set(own 0)
  foreach(symbol IN LISTS symbols)
    if(symbol MATCHES " [WVu] " AND NOT symbol MATCHES " _ZNK?3hwy[0-9]+N_")
      message(SEND_ERROR "${name}: weak definition ${symbol}")
      set(failed TRUE)
    elseif(symbol MATCHES " [TDBR] ")
      math(EXPR own "${own} + 1")
      if(NOT symbol MATCHES " T ${OWN}")
        message(SEND_ERROR "${name}: global definition ${symbol}")
        set(failed TRUE)
      endif()
    endif()
  endforeach()
  if(NOT own EQUAL 1)
    message(SEND_ERROR "${name}: ${own} global definitions; wanted: one, the kernels' function")
    set(failed TRUE)
  endif()
endforeach()
list(LENGTH OBJECTS count)
if(count EQUAL 0 OR failed)
  message(FATAL_ERROR "kernel_symbols: ${count} object files, failed")
endif()
