# SPDX-License-Identifier: MIT
# The page and the clients to download, built into the library: embed.cmake makes a C++ file of them.
set(clients ${PROJECT_SOURCE_DIR}/clients)
file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/page/*)
file(GLOB_RECURSE matlab_files CONFIGURE_DEPENDS RELATIVE ${clients}/matlab ${clients}/matlab/*.m)
file(GLOB python_client CONFIGURE_DEPENDS ${clients}/python/coopdyn.py)

set(assets "")
foreach(file ${page_files} ${python_client})
  cmake_path(GET file FILENAME name)
  list(APPEND assets "/${name}=${file}")
endforeach()

set(matlab_paths ${matlab_files})
list(TRANSFORM matlab_paths PREPEND ${clients}/matlab/)
set(matlab_zip "")
if(matlab_files)
  set(matlab_zip ${CMAKE_CURRENT_BINARY_DIR}/matlab.zip)
  list(APPEND assets "/matlab.zip=${matlab_zip}")
  add_custom_command(
    OUTPUT ${matlab_zip}
    COMMAND ${CMAKE_COMMAND} -E tar cf ${matlab_zip} --format=zip -- ${matlab_files}
    DEPENDS ${matlab_paths}
    WORKING_DIRECTORY ${clients}/matlab
    VERBATIM)
endif()

set(assets_source ${CMAKE_CURRENT_BINARY_DIR}/assets_data.cc)
add_custom_command(
  OUTPUT ${assets_source}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${assets_source} "-DASSETS=${assets}" -P ${CMAKE_CURRENT_SOURCE_DIR}/embed.cmake
  DEPENDS ${page_files} ${python_client} ${matlab_zip} ${CMAKE_CURRENT_SOURCE_DIR}/embed.cmake
  VERBATIM)
coopdyn_generated_source(coopdyn_web ${assets_source})
