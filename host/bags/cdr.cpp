// CDR, see cdr.hpp. Sources: OMG CORBA 3.4 part 2, 9.3 (plain CDR, "XCDR1"); OMG DDS-XTypes 1.3, 7.4 (XCDR2, encapsulation).
#include "host/bags/cdr.hpp"

#include <array>

#include "host/bags/cursor.hpp"
#include "host/core/message.hpp"

namespace furcula::bags {
namespace {

/// Of numbers and bool.
constexpr std::array<std::size_t, 11> kSizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 1};

double number(FieldType type, Cursor& c) {
  switch (type) {
    case FieldType::i8:
      return c.number<std::int8_t>();
    case FieldType::u8:
      return c.number<std::uint8_t>();
    case FieldType::boolean:
      return c.number<std::uint8_t>() != 0 ? 1.0 : 0.0;
    case FieldType::i16:
      return c.number<std::int16_t>();
    case FieldType::u16:
      return c.number<std::uint16_t>();
    case FieldType::i32:
      return c.number<std::int32_t>();
    case FieldType::u32:
      return c.number<std::uint32_t>();
    case FieldType::i64:
      return static_cast<double>(c.number<std::int64_t>());
    case FieldType::u64:
      return static_cast<double>(c.number<std::uint64_t>());
    case FieldType::f32:
      return static_cast<double>(c.number<float>());
    case FieldType::f64:
      return c.number<double>();
    case FieldType::text:
    case FieldType::wide_text:
    case FieldType::message:
      break;
  }
  return 0.0;
}

/// What no message is to be read with.
struct Unreadable {
  std::string why;
};

/// Goes through a message. `Take` may keep paths: enter(name), element(i), value() and leave().
template <class Take>
class Walk {
 public:
  Walk(const Definition& definition, Cursor& cursor, Decoded& to, const Take& take)
      : definition_(definition), cursor_(cursor), to_(to), take_(take) {}

  void message(const MessageForm& form, bool used) {
    // Parts without any byte cost time alone: a definition may have billions of them.
    if (++parts_ > kMostParts + cursor_.left()) throw Unreadable{"it has too many parts"};
    const bool time = form.type == "builtin_interfaces/Time" && used && form.fields.size() == 2;
    const std::size_t first = to_.values.size();
    for (const Field& f : form.fields) {
      take_.enter(f.name);
      field(f, used);
      take_.leave();
    }
    // The first one at the top or in the header is the message's.
    if (time && depth_ <= 2 && to_.stamp_ns == 0 && to_.values.size() == first + 2)
      to_.stamp_ns = static_cast<std::int64_t>(to_.values[first]) * 1000000000 +
                     static_cast<std::int64_t>(to_.values[first + 1]);
  }

 private:
  static constexpr std::size_t kMostParts = 100000;

  void field(const Field& f, bool used) {
    std::uint64_t count = f.count == Field::Count::fixed ? f.fixed : 1;
    if (f.count == Field::Count::sequence) {
      count = cursor_.number<std::uint32_t>();
      if (used) to_.form.push_back(static_cast<std::uint32_t>(count));
    }
    if (f.type == FieldType::wide_text) throw Unreadable{"it has the field '" + f.name + "' of type wstring"};
    const bool array = f.count != Field::Count::one;
    if (f.type == FieldType::text) {
      for (std::uint64_t i = 0; i < count; ++i) {
        std::string_view text = cursor_.text();
        if (!used || f.count != Field::Count::sequence || count > kMostElements) continue;
        if (text.ends_with('\0')) text.remove_suffix(1);
        to_.texts.append(text.substr(0, text.find('\0')));
        to_.texts += '\0';
      }
    } else if (f.type == FieldType::message) {
      const bool elements = used && count <= kMostElements;
      ++depth_;
      for (std::uint64_t i = 0; i < count; ++i) {
        const std::size_t before = cursor_.left();
        if (array) take_.element(i);
        message(definition_.messages[f.message], elements);
        if (array) take_.leave();
        if (cursor_.left() == before) break;  // nor do the others
      }
      --depth_;
    } else if (!used || count > kMostElements || to_.values.size() + count > kMostValues) {
      cursor_.skip(count, kSizes[static_cast<std::size_t>(f.type)]);
    } else {
      for (std::uint64_t i = 0; i < count; ++i) {
        to_.values.push_back(number(f.type, cursor_));
        if (array) take_.element(i);
        take_.value();
        if (array) take_.leave();
      }
    }
  }

  const Definition& definition_;
  Cursor& cursor_;
  Decoded& to_;
  const Take& take_;
  int depth_ = 0;
  std::size_t parts_ = 0;
};

struct NoNames {
  void enter(const std::string& /*name*/) const {}
  void element(std::uint64_t /*i*/) const {}
  void value() const {}
  void leave() const {}
};

struct Names {
  std::vector<std::string>& names;
  mutable std::string path;
  mutable std::vector<std::size_t> lengths;

  void enter(const std::string& name) const {
    lengths.push_back(path.size());
    path += (path.empty() ? "" : "/") + name;
  }
  void element(std::uint64_t i) const {
    lengths.push_back(path.size());
    path += "[" + std::to_string(i) + "]";
  }
  void value() const { names.push_back(path); }
  void leave() const {
    path.resize(lengths.back());
    lengths.pop_back();
  }
};

}  // namespace

template <class Take>
std::string CdrDecoder::walk(std::string_view data, Decoded& to, const Take& take) const {
  to.clear();
  if (data.size() < 4)
    return "it has " + std::to_string(data.size()) + " bytes; expected at least four (CDR)";
  // The encapsulation: representation, then two bytes of options.
  const auto representation =
      static_cast<unsigned>(static_cast<unsigned char>(data[0]) << 8 | static_cast<unsigned char>(data[1]));
  const bool second = representation == 6 || representation == 7;
  if (representation > 1 && !second)
    return "it has the CDR representation " + std::to_string(representation) +
           "; expected plain CDR (0, 1, 6 or 7), as ROS 2 writes";
  Cursor cursor(data.substr(4));
  cursor.align_to(second ? 4 : 8);
  cursor.swap_bytes(representation % 2 == 0);
  try {
    Walk<Take>(definition_, cursor, to, take).message(definition_.messages.front(), true);
  } catch (const Cut&) {
    return "its " + std::to_string(data.size()) + " bytes end before its fields do";
  } catch (const Unreadable& e) {
    return e.why;
  }
  return {};
}

std::string CdrDecoder::decode(std::string_view data, Decoded& to) const { return walk(data, to, NoNames{}); }

std::vector<std::string> CdrDecoder::names(std::string_view data) const {
  std::vector<std::string> names;
  Decoded ignored;
  walk(data, ignored, Names{names, {}, {}});
  return names;
}

}  // namespace furcula::bags
