cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/common.cmake)

# Installs the libraries of BUILD_DIR to PREFIX for the tests of the package.
#
#   cmake -DBUILD_DIR=... -DPREFIX=... -P install.cmake
file(REMOVE_RECURSE ${PREFIX})
must(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${PREFIX})
