# CPack runs this between the installation into its own directory and the making of the packages; see
# HardbodyPackage.cmake.
function(hardbody_gzip file)
  # -n: no time, no name; the same bytes every time.
  execute_process(COMMAND gzip -9n ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/share)
  set(doc ${root}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  file(REMOVE_RECURSE ${root}/doc)  # LICENSE: its text is in copyright
  file(COPY_FILE ${CPACK_HARDBODY_CHANGELOG} ${CPACK_TEMPORARY_DIRECTORY}/changelog)
  file(MAKE_DIRECTORY ${doc})
  file(RENAME ${CPACK_TEMPORARY_DIRECTORY}/changelog ${doc}/changelog)
  file(COPY_FILE ${CPACK_HARDBODY_COPYRIGHT} ${doc}/copyright)
  file(GLOB pages ${root}/man/*/*.1)
  foreach(file IN LISTS pages ITEMS ${doc}/changelog)
    hardbody_gzip(${file})
  endforeach()
  file(CHMOD_RECURSE ${root} FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ
    DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endforeach()
