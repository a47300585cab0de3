# cmake -DINPUT=file -DOUTPUT=file.cpp -DNAME=identifier -P embed.cmake
# A text file as `const std::string_view furcula::report::assets::<NAME>`, without its closing source-map comment
# ("//# sourceMappingURL=" or "/*# sourceMappingURL="): a report must not refer to another file.
file(READ ${INPUT} hex HEX)
string(REGEX REPLACE "2f2[fa]2320736f757263654d617070696e6755524c3d.*$" "" hex "${hex}")
string(LENGTH "${hex}" length)
math(EXPR bytes "${length} / 2")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," hex "${hex}")
string(REPEAT "0x[0-9a-f][0-9a-f]," 20 row)
string(REGEX REPLACE "(${row})" "\\1\n" hex "${hex}")
get_filename_component(file_name ${INPUT} NAME)
file(WRITE ${OUTPUT} "// Made from ${file_name} by host/report/embed.cmake.
#include \"host/report/assets.hpp\"
namespace furcula::report::assets {
namespace {
constexpr unsigned char kBytes[${bytes}] = {
${hex}};
}
const std::string_view ${NAME}{reinterpret_cast<const char*>(kBytes), sizeof kBytes};
}  // namespace furcula::report::assets
")
