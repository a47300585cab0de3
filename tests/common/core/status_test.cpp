// Status and Result.
#include "furcula/core/status.hpp"

#include <catch2/catch.hpp>

using furcula::Result;
using furcula::Status;

TEST_CASE("a result holds a value, or the status that says why there is none") {
  const Result<int> value = 7;
  CHECK(value.ok());
  CHECK(value.status() == Status::ok);
  CHECK(value.value() == 7);
  const Result<int> none = Status::disconnected;
  CHECK_FALSE(none.ok());
  CHECK(none.status() == Status::disconnected);
}
