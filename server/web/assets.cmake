# SPDX-License-Identifier: MIT
# Builds the page and the downloadable clients into the library: embed.cmake turns them into a C++ file.
set(clients ${PROJECT_SOURCE_DIR}/clients)
file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/page/*.html ${CMAKE_CURRENT_SOURCE_DIR}/page/*.svg)
file(GLOB scripts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/page/*.js ${CMAKE_CURRENT_SOURCE_DIR}/page/*.css)
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

# Installs the page's libraries by its lock file, then bundles its scripts and styles with all their imports.
find_program(NPM npm REQUIRED)
set(packages ${CMAKE_CURRENT_BINARY_DIR}/packages)
set(bundle ${CMAKE_CURRENT_BINARY_DIR}/bundle)
set(entries app.js style.css login.js login.css wall.js wall.css sheet.css)
list(TRANSFORM entries PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/page/)
add_custom_command(
  OUTPUT ${packages}/installed
  COMMAND ${CMAKE_COMMAND} -DPAGE=${CMAKE_CURRENT_SOURCE_DIR}/page -DPACKAGES=${packages} -DNPM=${NPM}
          -P ${CMAKE_CURRENT_SOURCE_DIR}/packages.cmake
  DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/page/package-lock.json ${CMAKE_CURRENT_SOURCE_DIR}/packages.cmake
  VERBATIM)
add_custom_command(
  OUTPUT ${bundle}/app.js
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${bundle}
  COMMAND ${CMAKE_COMMAND} -E env NODE_PATH=${packages}/node_modules ${packages}/node_modules/.bin/esbuild
          ${entries} --bundle --splitting "--external:*.svg"
          --format=esm --minify --legal-comments=none --target=es2022 --log-level=warning --outdir=${bundle}
  DEPENDS ${scripts} ${packages}/installed
  VERBATIM)

set(assets_source ${CMAKE_CURRENT_BINARY_DIR}/assets_data.cc)
add_custom_command(
  OUTPUT ${assets_source}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${assets_source} "-DASSETS=${assets}" -DBUNDLE=${bundle}
          -P ${CMAKE_CURRENT_SOURCE_DIR}/embed.cmake
  DEPENDS ${page_files} ${bundle}/app.js ${python_client} ${matlab_zip} ${CMAKE_CURRENT_SOURCE_DIR}/embed.cmake
  VERBATIM)
coopdyn_generated_source(coopdyn_web ${assets_source})
