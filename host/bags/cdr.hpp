// Decodes messages in CDR (OMG's Common Data Representation, as DDS and so ROS 2 writes them), by the message's definition.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/bags/decoded.hpp"
#include "host/bags/definition.hpp"

namespace furcula::bags {

class CdrDecoder {
 public:
  explicit CdrDecoder(Definition definition) : definition_(std::move(definition)) {}

  const Definition& definition() const { return definition_; }

  /// `to` is overwritten. @returns why the message cannot be read; empty: it was.
  std::string decode(std::string_view data, Decoded& to) const;

  /// The paths of the numbers of a message, as in "header/stamp/sec" and "data[0]", in their order. It must be one that decode() reads.
  std::vector<std::string> names(std::string_view data) const;

 private:
  template <class Take>
  std::string walk(std::string_view data, Decoded& to, const Take& take) const;

  Definition definition_;
};

}  // namespace furcula::bags
