# Options of all targets, and a short function for each kind of target.
option(COOPDYN_TESTS "Build the tests and benchmarks" ${PROJECT_IS_TOP_LEVEL})
set(COOPDYN_SANITIZE "" CACHE STRING "Sanitizers for every target, e.g. address,undefined or thread")
set(COOPDYN_UNIT_TESTS ON CACHE STRING "Unit tests to build: ON, or release, asan or tsan for those of ./check all")
option(COOPDYN_NIGHT "Build what only ./check night runs" OFF)
option(COOPDYN_COVERAGE "Instrument for coverage" OFF)
option(COOPDYN_FUZZ "Build the targets of libFuzzer, and instrument what they test (clang only)" OFF)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(COOPDYN_CCACHE ccache)
if(COOPDYN_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${COOPDYN_CCACHE})
endif()

# Enable warnings only for the targets of this source tree, not for a project that adds it and links its libraries.
define_property(TARGET PROPERTY COOPDYN_WARNINGS INITIALIZE_FROM_VARIABLE COOPDYN_WARNINGS)
set(COOPDYN_WARNINGS ON)
set(ours $<BOOL:$<TARGET_PROPERTY:COOPDYN_WARNINGS>>)

add_library(coopdyn_options INTERFACE)
target_compile_options(coopdyn_options INTERFACE
  $<${ours}:-Wall> $<${ours}:-Wextra> $<${ours}:-Wpedantic> $<${ours}:-Werror> -fno-fast-math
  -ffp-contract=off)  # a * b + c is rounded twice on every machine
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  target_compile_options(coopdyn_options INTERFACE -U__ARM_FEATURE_FMA)  # otherwise Eigen calls the fused instruction explicitly
endif()
target_include_directories(coopdyn_options INTERFACE ${PROJECT_SOURCE_DIR})
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(coopdyn_options INTERFACE $<${ours}:-Wthread-safety>)
endif()
if(COOPDYN_SANITIZE)
  target_compile_options(coopdyn_options INTERFACE
    -fsanitize=${COOPDYN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(coopdyn_options INTERFACE -fsanitize=${COOPDYN_SANITIZE})
  target_sources(coopdyn_options INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${PROJECT_SOURCE_DIR}/cmake/sanitizer_options.cc>)
  if(COOPDYN_SANITIZE MATCHES "address")  # the thread sanitizer must see what libraries do with shared pointers
    target_link_options(coopdyn_options INTERFACE
      $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/local_symbols.map>)
  endif()
  if(COOPDYN_SANITIZE MATCHES "undefined")
    # The vptr check needs a file descriptor, and reports a valid vptr as invalid when a test has used them up. The
    # null check makes GCC 12 compile some uses of Eigen for minutes, and a null that is used crashes anyway. The
    # alignment check takes a fifth of the build time, and our codecs copy bytes instead of pointing at them.
    target_compile_options(coopdyn_options INTERFACE -fno-sanitize=vptr,null,alignment)
    target_link_options(coopdyn_options INTERFACE -fno-sanitize=vptr,null,alignment)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # With instrumentation, GCC 12 warns about libstdc++'s own std::function in <regex>.
    target_compile_options(coopdyn_options INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC mistakes types local to one of the joined sources for parts of a header.
  target_compile_options(coopdyn_options INTERFACE -Wno-subobject-linkage)
endif()
if(COOPDYN_COVERAGE)
  target_compile_options(coopdyn_options INTERFACE --coverage)
  target_link_options(coopdyn_options INTERFACE --coverage)
endif()

# Adds a library of all *.cc in this folder and in its subfolders FOLDERS. LINK names our libraries and external ones alike.
# Sanitized builds optimise only OPTIMIZED libraries, which compute: the other ones compile in a quarter of the time that way.
function(coopdyn_library name)
  cmake_parse_arguments(ARG "OPTIMIZED" "" "FOLDERS;LINK" ${ARGN})
  list(TRANSFORM ARG_FOLDERS APPEND "/*.cc")
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc ${ARG_FOLDERS})
  list(FILTER sources EXCLUDE REGEX "/main\\.cc$")
  if(sources)
    add_library(${name} STATIC ${sources})
    target_link_libraries(${name} PUBLIC coopdyn_options ${ARG_LINK})
    if(ARG_OPTIMIZED AND COOPDYN_SANITIZE)
      target_compile_options(${name} PRIVATE -O1)
    endif()
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE coopdyn_options ${ARG_LINK})
  endif()
endfunction()

# Adds a generated source to the library, as its own library: a command waits until all libraries that its library
# links are built, and the library's other sources would wait with it.
function(coopdyn_generated_source library source)
  cmake_path(GET source STEM name)
  add_library(coopdyn_${name} STATIC ${source})
  set_target_properties(coopdyn_${name} PROPERTIES UNITY_BUILD OFF)
  target_link_libraries(coopdyn_${name} PRIVATE coopdyn_options)
  target_link_libraries(${library} PRIVATE coopdyn_${name})
endfunction()

# Adds one test program from all *.cc of this folder. It is one CTest test, because it takes longer to start than most of its
# tests take to run; --gtest_filter=… runs some of them. Tests are most of the compiled code, and only those that compute
# much are worth optimising: OPTIMIZED. Long programs run in several PARTS. IN names the builds that run it in `./check all`:
# release for computations, which optimisation may change; asan for bytes and lifetimes; tsan for threads. The thread sanitizer
# never runs other programs, and compiles only the tests in the sources THREADED (globs) if there are some. LARGE are tests of
# large inputs, whose code smaller ones test too: there the sanitized builds of `all` omit them, as they would take minutes.
function(coopdyn_test name)
  cmake_parse_arguments(ARG "OPTIMIZED" "PARTS" "IN;LARGE;LINK;THREADED" ${ARGN})
  if(NOT ARG_IN)
    set(ARG_IN asan tsan)
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  if(NOT sources)
    return()
  endif()
  if(ARG_THREADED AND COOPDYN_SANITIZE STREQUAL "thread")
    list(FILTER sources EXCLUDE REGEX "_test\\.cc$")
    foreach(pattern ${ARG_THREADED})
      file(GLOB threaded CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${pattern})
      if(NOT threaded)
        message(FATAL_ERROR "${name}: no source is named ${pattern}: correct THREADED in ${CMAKE_CURRENT_SOURCE_DIR}")
      endif()
      list(APPEND sources ${threaded})
    endforeach()
  endif()
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE coopdyn_options ${ARG_LINK} coopdyn_source_dir GTest::gtest GTest::gmock
                        GTest::gtest_main)
  if(NOT ARG_OPTIMIZED)
    target_compile_options(${name} PRIVATE -O0)
  endif()
  if((COOPDYN_SANITIZE STREQUAL "thread" AND NOT tsan IN_LIST ARG_IN) OR
     (NOT COOPDYN_UNIT_TESTS IN_LIST ARG_IN AND NOT COOPDYN_UNIT_TESTS STREQUAL "ON"))
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  endif()
  set(filter *)
  if(ARG_LARGE AND COOPDYN_SANITIZE AND NOT COOPDYN_UNIT_TESTS STREQUAL "ON")
    list(JOIN ARG_LARGE ":" large)
    set(filter "*-${large}")
  endif()
  if(NOT ARG_PARTS)
    set(ARG_PARTS 1)
  endif()
  math(EXPR last "${ARG_PARTS} - 1")
  foreach(part RANGE ${last})
    set(test_name ${name})
    if(ARG_PARTS GREATER 1)
      string(APPEND test_name _${part})
    endif()
    add_test(NAME ${test_name} COMMAND ${name} --gtest_brief=1)
    set_tests_properties(${test_name} PROPERTIES COST 1000 TIMEOUT 1200
                         ENVIRONMENT
      "GTEST_FILTER=${filter};GTEST_TOTAL_SHARDS=${ARG_PARTS};GTEST_SHARD_INDEX=${part}")
  endforeach()
endfunction()
