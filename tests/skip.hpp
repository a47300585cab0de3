// Marks the running test case as skipped, with the reason; return from the case right after it.
#pragma once

namespace furcula::test {
void skip(const char* reason);
}
