# furcula_warnings(target): the project's own code compiles without a warning. With the compilers of Debian 12, which CI has, a warning is an
# error; newer ones know further warnings.
function(furcula_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Wold-style-cast)
  if((CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13) OR
     (CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15))
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 warns of impossible overlaps inside std::string's operator+ at -O3 (its bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
    if(CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
      # It takes the text of a message for the owner of the table that is returned (its bug 107532).
      target_compile_options(${target} PRIVATE -Wno-dangling-reference)
    endif()
  endif()
endfunction()
