# CPack runs this between the installation into its own directory and the making of the packages; see
# HardbodyPackage.cmake.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is set
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(share ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/share)
  set(doc ${share}/doc/${package})
  file(REMOVE_RECURSE ${share}/doc)  # LICENSE: its text is in copyright
  file(MAKE_DIRECTORY ${doc})
  file(COPY_FILE ${CPACK_HARDBODY_COPYRIGHT} ${doc}/copyright)
  file(COPY_FILE ${CPACK_HARDBODY_CHANGELOG} ${doc}/changelog)
  file(WRITE ${doc}/changelog.Debian
    "hardbody (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
    "  * Version ${CPACK_PACKAGE_VERSION}; what is new is in changelog.gz.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  file(GLOB pages ${share}/man/*/*.1)
  foreach(file IN LISTS pages ITEMS ${doc}/changelog ${doc}/changelog.Debian)
    # -n: no time, no name; the same bytes every time.
    execute_process(COMMAND gzip -9n ${file} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  # Set whatever the umask is; other files have their permissions from install().
  set(readable OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  set(enterable ${readable} OWNER_EXECUTE GROUP_EXECUTE WORLD_EXECUTE)
  file(CHMOD_RECURSE ${share} FILE_PERMISSIONS ${readable} DIRECTORY_PERMISSIONS ${enterable})
  file(GLOB_RECURSE entries LIST_DIRECTORIES true ${CPACK_TEMPORARY_DIRECTORY}/${component}/*)
  foreach(entry IN LISTS entries)
    if(IS_DIRECTORY ${entry})
      file(CHMOD ${entry} PERMISSIONS ${enterable})
    endif()
  endforeach()
endforeach()
