# Registers each *_test.py of this folder as one CTest test PREFIX.module, with the daemon's binary in COOPDYN_BINARY. One test
# per method would spend as long in starting Python as in most methods.
function(coopdyn_python_tests prefix)
  cmake_parse_arguments(ARG "" "" "LABELS" ${ARGN})
  if(NOT TARGET coopdyn)
    return()
  endif()
  file(GLOB test_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_test.py)
  foreach(test_file ${test_files})
    cmake_path(GET test_file STEM module)
    add_test(NAME ${prefix}.${module} COMMAND python3 -m unittest ${module} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    set_tests_properties(${prefix}.${module} PROPERTIES TIMEOUT 1200 LABELS "${ARG_LABELS}"
                         ENVIRONMENT "COOPDYN_BINARY=$<TARGET_FILE:coopdyn>;PYTHONDONTWRITEBYTECODE=1")
  endforeach()
endfunction()
