#!/bin/sh
# Links an image from one source as furcula_image() does, and lets the linker speak: link_image.sh ROOT SOURCE
set -u
if ! command -v arm-none-eabi-g++ > /dev/null; then
  echo "SKIPPED: arm-none-eabi-g++ is not installed (scripts/setup installs it)"; exit 77
fi
out=$(mktemp) || exit 1
trap 'rm -f "$out"' EXIT
arm-none-eabi-g++ -std=c++20 -O2 -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard -fno-exceptions \
  -fno-rtti -I"$1" -nostartfiles -T "$1/firmware/startup/stm32f405.ld" "$2" "$1/firmware/startup/startup.cpp" -o "$out"
