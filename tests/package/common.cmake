# For the scripts beside this one.
function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${status}): ${command}")
  endif()
endfunction()

# must_print(<variable> <command>...): what the command writes to standard output.
function(must_print variable)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${status}): ${command}")
  endif()
  set(${variable} "${output}" PARENT_SCOPE)
endfunction()

# configure_consumer(<result> <directory> <flags>): the outside project in consumer/, against PREFIX.
function(configure_consumer variable directory flags)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/consumer -B ${directory}
      "-DCOMPONENTS=${COMPONENTS}" "-DOPTIONAL=${OPTIONAL}" "-DHIDDEN=${HIDDEN}" -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} "-DCMAKE_CXX_FLAGS=${flags}"
    RESULT_VARIABLE status ERROR_VARIABLE errors)
  if(errors)
    message(STATUS "${errors}")
  endif()
  set(${variable} ${status} PARENT_SCOPE)
  set(configure_errors "${errors}" PARENT_SCOPE)
endfunction()

# build_consumer(<directory> <flags> <program>...): builds and runs these of its programs, named without _consumer.
function(build_consumer directory flags)
  configure_consumer(status ${directory} "${flags}")
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the consumer cannot be configured")
  endif()
  list(TRANSFORM ARGN APPEND _consumer OUTPUT_VARIABLE programs)
  if(NOT programs)
    message(FATAL_ERROR "no program of the consumer is asked for")
  endif()
  must(${CMAKE_COMMAND} --build ${directory} --target ${programs})
  foreach(program IN LISTS programs)
    must(${directory}/${program})
  endforeach()
endfunction()
