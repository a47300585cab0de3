# FURCULA_SANITIZE=address,undefined: every target is built with these sanitizers, and a finding ends the program.
if(FURCULA_SANITIZE)
  add_compile_options(-fsanitize=${FURCULA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${FURCULA_SANITIZE})
endif()
# FURCULA_FUZZ: libFuzzer sees which branches an input takes, in the rooms' libraries too.
if(FURCULA_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
