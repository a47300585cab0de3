# furcula_stm32f4_robot(name): the image of a board of an STM32F4, of its folder's wiring.cpp: bin/<name>.elf and .bin, with
# the header that `furcula flash` checks.
include(firmware_image)
function(furcula_stm32f4_robot name)
  furcula_image(${name} LINKER_SCRIPT ${PROJECT_SOURCE_DIR}/firmware/chip/stm32f4/stm32f4x5xg.ld
    SOURCES wiring.cpp ${PROJECT_SOURCE_DIR}/firmware/chip/stm32f4/robot_main.cpp)
  math(EXPR version "${PROJECT_VERSION_MAJOR} << 16 | ${PROJECT_VERSION_MINOR} << 8 | ${PROJECT_VERSION_PATCH}")
  target_compile_definitions(${name} PRIVATE FURCULA_BOARD="${name}" FURCULA_VERSION="${PROJECT_VERSION}"
    FURCULA_VERSION_NUMBER=${version}u)
  # Long-lived objects are made in main(), one after the other: no guard needs a lock.
  target_compile_options(${name} PRIVATE -fno-threadsafe-statics)
  # With -O3 it is 5 kB larger and does not fit into its sectors. boards/qemu_robot_tick measures the tick so.
  target_compile_options(${name} PRIVATE -O2)
  # The build's number is a hash of what is linked.
  target_link_options(${name} PRIVATE -Wl,--build-id=sha1)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/finish-image $<TARGET_FILE:${name}> VERBATIM)
endfunction()
