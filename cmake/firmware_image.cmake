# furcula_image(name LINKER_SCRIPT script SOURCES...): bin/<name>.elf for a Cortex-M4F, with a map and, for the size
# budget (scripts/size-budget), each function's stack use and callees (*.ci beside the objects).
function(furcula_image name)
  cmake_parse_arguments(ARG "" "LINKER_SCRIPT" "SOURCES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES} ${PROJECT_SOURCE_DIR}/firmware/startup/startup.cpp)
  set_target_properties(${name} PROPERTIES SUFFIX .elf LINK_DEPENDS ${ARG_LINKER_SCRIPT})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE furcula::furcula)
  furcula_warnings(${name})
  target_compile_options(${name} PRIVATE -Wdouble-promotion -fcallgraph-info=su -fstack-usage)
  # No start files and no system calls: newlib gives memcpy and its like, and nothing that needs _sbrk links.
  target_link_options(${name} PRIVATE -nostartfiles -T ${ARG_LINKER_SCRIPT} -Wl,--gc-sections -Wl,--fatal-warnings
    -Wl,-Map=$<TARGET_FILE:${name}>.map)
endfunction()
