// Nodes as the command line names them.
#include "host/bus/nodes.hpp"

#include <catch2/catch.hpp>

#include "tests/host/error_message.hpp"

using namespace furcula;
using namespace furcula::bus;
using Catch::Contains;

TEST_CASE("a node is a name, a protocol, an id, and a motor where the range depends on it") {
  const Node knee = parse_node("Knee=mini_cheetah:4:ak70_10");
  CHECK(knee.name == "Knee");
  CHECK(knee.protocol == Protocol::mini_cheetah);
  CHECK(knee.id == 4);
  CHECK(knee.motor == Motor::ak70_10);
  CHECK(parse_node("a_1=odrive:31").id == 31);
}

TEST_CASE("a node that makes no sense is refused with what was expected") {
  const auto message = [](const char* text) { return test::error_message([&] { parse_node(text); }); };
  CHECK_THAT(message(""), Contains("expected NAME=PROTOCOL:ID"));
  CHECK_THAT(message("Nine_long=odrive:1"), Contains("up to 7 more"));
  CHECK_THAT(message("1a=odrive:1"), Contains("name '1a'"));
  CHECK_THAT(message("Host=odrive:1"), Contains("expected another name"));
  CHECK_THAT(message("a=odriv:1"), Contains("no protocol 'odriv'") && Contains("did you mean 'odrive'?"));
  for (const char* text :
       {"a=odrive:0", "a=odrive:32", "a=odrive:", "a=odrive:1x", "a=odrive:-1", "a=odrive"})
    CHECK_THAT(message(text), Contains("expected a whole number from 1 to 31"));
  CHECK_THAT(message("a=odrive:1:ak80_9"), Contains("'ak80_9' after the id; expected nothing"));
  CHECK_THAT(message("a=mini_cheetah:1"), Contains("no motor ''; expected one of mini_cheetah, ak10_9"));
}

TEST_CASE("two nodes that cannot be told apart are refused") {
  const auto message = [](std::vector<Node> nodes) {
    return test::error_message([&] { check_nodes(nodes); });
  };
  CHECK(message(usual_nodes()).empty());
  CHECK_THAT(message({{"a", Protocol::odrive, 1}, {"a", Protocol::encoder, 1}}),
             Contains("'a' is there twice"));
  CHECK_THAT(message({{"a", Protocol::odrive, 1}, {"b", Protocol::odrive, 1}}),
             Contains("'a' and 'b' are both odrive 1"));
}
