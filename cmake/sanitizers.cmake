# FURCULA_SANITIZE=address,undefined: every target is built with these sanitizers, and a finding ends the program.
if(FURCULA_SANITIZE)
  add_compile_options(-fsanitize=${FURCULA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # gcc 12 warns of members of the standard library's regular expressions that the instrumented code does set.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized>)
  endif()
  add_link_options(-fsanitize=${FURCULA_SANITIZE})
endif()
# FURCULA_FUZZ: libFuzzer sees which branches an input takes, in the rooms' libraries too.
if(FURCULA_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
