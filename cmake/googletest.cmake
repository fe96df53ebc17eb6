# GoogleTest and GoogleMock with their main() as the target cia402_googletest. By their libraries, for
# CMake's own search knows no GoogleMock before 3.20, and after catkin's search GoogleTest's own CMake
# files find half of their targets defined and give up.
add_library(cia402_googletest INTERFACE)
foreach(library gtest_main gmock gtest)  # in the linker's order
  find_library(CIA402_${library} ${library})
  if(NOT CIA402_${library})
    message(FATAL_ERROR "no library ${library}: install libgtest-dev and libgmock-dev, or configure "
      "with -DCIA402_BUILD_TESTS=OFF")
  endif()
  target_link_libraries(cia402_googletest INTERFACE ${CIA402_${library}})
endforeach()
target_link_libraries(cia402_googletest INTERFACE Threads::Threads)
