// The CDR codec of the generated messages: XCDR version 1, as ROS 2 sends it. C++17, no exceptions of its own.
//
// Each message has ifgen::Traits, whose function `fields` hands its fields to a stream in wire order. A stream is
// anything with `run` (fields of fixed layout, named, in one block) and `field` (any other field).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace ifgen
{

/// What encoding or decoding returned. It is true on success.
struct [[nodiscard]] Status
{
  const char * problem = nullptr;  ///< what is wrong, or null
  std::string field{};             ///< where: `joints[3].name`; empty for the message itself

  explicit operator bool() const {return problem == nullptr;}

  /// `joints[3].name: expected at most 8 characters`, or `ok`.
  std::string text() const
  {
    return problem == nullptr ? "ok" : field.empty() ? problem : field + ": " + problem;
  }
};

/// What the codec knows about a message, and the names of services and actions. Generated for each type.
template<class Type>
struct Traits;

template<class Type>
inline constexpr const char * type_name = Traits<Type>::type_name;

template<class Type>
inline constexpr const char * type_hash = Traits<Type>::type_hash;

inline constexpr std::size_t unbounded = static_cast<std::size_t>(-1);

/// The bounds of a field: elements of a sequence, characters of a string.
struct Bound
{
  std::size_t count = unbounded;
  std::size_t characters = unbounded;
};

namespace detail
{

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
inline constexpr bool big_endian_host = true;
#else
inline constexpr bool big_endian_host = false;
#endif

inline constexpr std::size_t header_size = 4;

constexpr std::size_t aligned(std::size_t position, std::size_t alignment)
{
  return (position + alignment - 1) & ~(alignment - 1);
}

/// Whether the memory of a type is its form on the wire (apart from the byte order), once its start is aligned.
template<class Type, class = void>
struct Layout
{
  static constexpr std::size_t size = Traits<Type>::plain_size;
  static constexpr std::size_t alignment = Traits<Type>::plain_alignment;
  static_assert(size == 0 || (size == sizeof(Type) && std::is_trivially_copyable_v<Type>),
    "the compiler puts padding where the wire has none");
};

template<class Type>
struct Layout<Type, std::enable_if_t<std::is_arithmetic_v<Type>>>
{
  static constexpr std::size_t size = sizeof(Type);
  static constexpr std::size_t alignment = sizeof(Type);
};

template<class Character>
struct Layout<std::basic_string<Character>, void>
{
  static constexpr std::size_t size = 0;
  static constexpr std::size_t alignment = 1;
};

template<class Element>
struct Layout<std::vector<Element>, void>
{
  static constexpr std::size_t size = 0;
  static constexpr std::size_t alignment = 1;
};

template<class Element, std::size_t count>
struct Layout<std::array<Element, count>, void>
{
  static constexpr std::size_t size = count * Layout<Element>::size;
  static constexpr std::size_t alignment = Layout<Element>::alignment;
};

template<class Type>
inline constexpr bool is_plain = Layout<Type>::size != 0;

/// The fewest bytes that a value takes on the wire, so that a count can be compared with what is left.
template<class Type, class = void>
struct Smallest
{
  static constexpr std::size_t size = Traits<Type>::minimum_size;
};

template<class Type>
struct Smallest<Type, std::enable_if_t<std::is_arithmetic_v<Type>>>
{
  static constexpr std::size_t size = sizeof(Type);
};

template<class Character>
struct Smallest<std::basic_string<Character>, void>
{
  static constexpr std::size_t size = 4;
};

/// Reverses the bytes of numbers in place.
struct Swapper
{
  template<class Type>
  static void swap(Type & value)
  {
    if constexpr (std::is_arithmetic_v<Type>) {
      unsigned char bytes[sizeof(Type)];
      std::memcpy(bytes, &value, sizeof(Type));
      for (std::size_t i = 0; i < sizeof(Type) / 2; ++i) {
        const unsigned char byte = bytes[i];
        bytes[i] = bytes[sizeof(Type) - 1 - i];
        bytes[sizeof(Type) - 1 - i] = byte;
      }
      std::memcpy(&value, bytes, sizeof(Type));
    } else {
      Swapper swapper;
      Traits<Type>::fields(swapper, value);
    }
  }

  template<class Element, std::size_t count>
  static void swap(std::array<Element, count> & values)
  {
    for (Element & value : values) {swap(value);}
  }

  template<class... Fields>
  bool run(const char *, Fields &&... fields)
  {
    each(fields...);
    return true;
  }

private:
  template<class Type, class... Rest>
  void each(Type & value, Rest &... rest)
  {
    swap(value);
    if constexpr (sizeof...(Rest) != 0) {next(rest...);}
  }

  template<class Name, class... Rest>
  void next(Name &, Rest &... rest) {each(rest...);}
};

/// Bytes of plain values, from memory to the wire.
template<class Type>
inline void store(std::uint8_t * to, const Type * from, std::size_t count)
{
  if constexpr (big_endian_host && (!std::is_arithmetic_v<Type> || sizeof(Type) != 1)) {
    for (std::size_t i = 0; i < count; ++i) {
      Type value = from[i];
      Swapper::swap(value);
      std::memcpy(to + i * sizeof(Type), &value, sizeof(Type));
    }
  } else {
    std::memcpy(to, from, count * sizeof(Type));
  }
}

inline std::uint32_t count_of(std::size_t count) {return static_cast<std::uint32_t>(count);}

#if defined(__GNUC__)
#define IFGEN_COLD [[gnu::noinline, gnu::cold]]
#else
#define IFGEN_COLD
#endif

/// Where a stream failed. The path grows from the inside out. None of this is on the way of a correct message.
class Failure
{
public:
  Status status{};

  bool fail(const char * problem)
  {
    status.problem = problem;
    return false;
  }

  bool within(const char * name)
  {
    prepend(name);
    return false;
  }

  bool within(std::size_t index)
  {
    prepend(index);
    return false;
  }

private:
  IFGEN_COLD void prepend(const std::string & name)
  {
    const bool member = !status.field.empty() && status.field.front() != '[';
    status.field = name + (member ? "." : "") + status.field;
  }

  IFGEN_COLD void prepend(std::size_t index) {prepend("[" + std::to_string(index) + "]");}
  IFGEN_COLD void prepend(const char * name) {prepend(std::string(name));}
};

#undef IFGEN_COLD

inline std::size_t characters_of(const std::string & text)
{
  std::size_t count = 0;
  for (const char byte : text) {count += (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;}
  return count;
}

inline std::size_t characters_of(const std::u16string & text)
{
  std::size_t count = 0;
  for (const char16_t unit : text) {count += (unit & 0xFC00U) != 0xDC00U;}
  return count;
}

template<class Text>
inline bool is_longer(const Text & text, std::size_t bound)
{
  return text.size() > bound && characters_of(text) > bound;
}

/// Whether a string holds NUL, where it would end on the wire. Most strings are short: no call for those.
inline bool has_nul(const char * text, std::size_t size)
{
  std::size_t i = 0;
  for (; i + 8 <= size; i += 8) {
    std::uint64_t word;
    std::memcpy(&word, text + i, 8);
    if (((word - 0x0101010101010101U) & ~word & 0x8080808080808080U) != 0) {return true;}
    if (i == 64) {return std::memchr(text + i, 0, size - i) != nullptr;}
  }
  for (; i < size; ++i) {
    if (text[i] == 0) {return true;}
  }
  return false;
}

template<class... Fields>
struct Run;

template<>
struct Run<>
{
  static constexpr std::size_t end(std::size_t position) {return position;}
};

template<class Name, class Type, class... Rest>
struct Run<Name, Type, Rest...>
{
  using First = std::remove_const_t<std::remove_reference_t<Type>>;
  static constexpr std::size_t alignment = Layout<First>::alignment;
  static constexpr std::size_t end(std::size_t position)
  {
    return Run<Rest...>::end(aligned(position, alignment) + Layout<First>::size);
  }
};

/// Adds up what a message takes, and checks all that writing takes for granted.
class Sizer : public Failure
{
public:
  std::size_t position = 0;

  template<class... Fields>
  bool run(const Fields &... fields)
  {
    using This = Run<Fields...>;
    (static_cast<void>(fields), ...);
    position = aligned(position, This::alignment) + This::end(0);
    return true;
  }

  template<class Type>
  bool field(const char * name, const Type & value, Bound bound = {})
  {
    return add(value, bound) || within(name);
  }

  bool placeholder()
  {
    ++position;
    return true;
  }

private:
  template<class Message>
  bool add(const Message & message, Bound)
  {
    return Traits<Message>::fields(*this, message);
  }

  bool add(const std::string & text, Bound bound)
  {
    if (is_longer(text, bound.characters)) {return fail("a string is longer than its bound");}
    if (has_nul(text.data(), text.size())) {return fail("a string ends at its NUL on the wire");}
    if (text.size() >= 0xFFFFFFFFU) {return fail("a string is longer than its count can say");}
    position = aligned(position, 4) + 5 + text.size();
    return true;
  }

  bool add(const std::u16string & text, Bound bound)
  {
    if (is_longer(text, bound.characters)) {return fail("a string is longer than its bound");}
    if (text.size() > 0xFFFFFFFFU) {return fail("a string is longer than its count can say");}
    position = aligned(position, 4) + 4 + 4 * text.size();
    return true;
  }

  template<class Element>
  bool add(const std::vector<Element> & values, Bound bound)
  {
    if (values.size() > bound.count) {return fail("a sequence has more elements than its bound");}
    if (values.size() > 0xFFFFFFFFU) {return fail("a sequence is longer than its count can say");}
    position = aligned(position, 4) + 4;
    return add_all(values, bound);
  }

  template<class Element, std::size_t count>
  bool add(const std::array<Element, count> & values, Bound bound)
  {
    return add_all(values, bound);
  }

  template<class Values>
  bool add_all(const Values & values, Bound bound)
  {
    using Element = typename Values::value_type;
    if constexpr (is_plain<Element>) {
      if (!values.empty()) {
        position = aligned(position, Layout<Element>::alignment) + values.size() * Layout<Element>::size;
      }
    } else {
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (!add(values[i], bound)) {return within(i);}
      }
    }
    return true;
  }
};

/// Writes a message for which a Sizer found room.
class Writer : public Failure
{
public:
  explicit Writer(std::uint8_t * body)
  : body_(body) {}

  template<class... Fields>
  bool run(const Fields &... fields)
  {
    align(Run<Fields...>::alignment);
    put<0>(body_ + position_, fields...);
    position_ += Run<Fields...>::end(0);
    return true;
  }

  template<class Type>
  bool field(const char *, const Type & value, Bound = {}) {return write(value);}

  bool placeholder()
  {
    body_[position_++] = 0;
    return true;
  }

private:
  std::uint8_t * body_;
  std::size_t position_ = 0;

  void align(std::size_t alignment)
  {
    const std::size_t start = aligned(position_, alignment);
    while (position_ < start) {body_[position_++] = 0;}
  }

  template<std::size_t position, class Type, class... Rest>
  static void put(std::uint8_t * start, const char *, const Type & value, const Rest &... rest)
  {
    constexpr std::size_t begin = aligned(position, Layout<Type>::alignment);
    for (std::size_t i = position; i < begin; ++i) {start[i] = 0;}
    store_one(start + begin, value);
    if constexpr (sizeof...(Rest) != 0) {put<begin + Layout<Type>::size>(start, rest...);}
  }

  template<class Type>
  static void store_one(std::uint8_t * to, const Type & value) {store(to, &value, 1);}

  template<class Element, std::size_t count>
  static void store_one(std::uint8_t * to, const std::array<Element, count> & values)
  {
    store(to, values.data(), count);
  }

  void count(std::size_t value)
  {
    align(4);
    store_one(body_ + position_, count_of(value));
    position_ += 4;
  }

  template<class Message>
  bool write(const Message & message) {return Traits<Message>::fields(*this, message);}

  bool write(const std::string & text)
  {
    count(text.size() + 1);
    std::memcpy(body_ + position_, text.c_str(), text.size() + 1);
    position_ += text.size() + 1;
    return true;
  }

  bool write(const std::u16string & text)
  {
    count(text.size());
    for (const char16_t unit : text) {
      store_one(body_ + position_, static_cast<std::uint32_t>(unit));
      position_ += 4;
    }
    return true;
  }

  template<class Element>
  bool write(const std::vector<Element> & values)
  {
    count(values.size());
    return write_all(values);
  }

  template<class Element, std::size_t size>
  bool write(const std::array<Element, size> & values) {return write_all(values);}

  template<class Values>
  bool write_all(const Values & values)
  {
    using Element = typename Values::value_type;
    if constexpr (std::is_same_v<Element, bool>) {
      for (const bool value : values) {body_[position_++] = value ? 1 : 0;}
    } else if constexpr (is_plain<Element>) {
      if (!values.empty()) {
        align(Layout<Element>::alignment);
        store(body_ + position_, values.data(), values.size());
        position_ += values.size() * Layout<Element>::size;
      }
    } else {
      for (const Element & value : values) {write(value);}
    }
    return true;
  }
};

/// Reads a message, and never outside the payload. `swap`: the payload has the other byte order.
template<bool swap>
class Reader : public Failure
{
public:
  Reader(const std::uint8_t * body, std::size_t size)
  : body_(body), size_(size) {}

  template<class... Fields>
  bool run(const char * name, Fields &&... fields)
  {
    using This = Run<const char *, Fields...>;
    const std::uint8_t * start = take(This::end(0), This::alignment);
    if (start == nullptr) {return fail(too_short) || within(name);}
    get<0>(start, name, fields...);
    return true;
  }

  template<class Type>
  bool field(const char * name, Type & value, Bound bound = {})
  {
    return read(value, bound) || within(name);
  }

  bool placeholder() {return take(1, 1) != nullptr || fail(too_short);}

private:
  static constexpr const char * too_short = "the payload ends before the message";

  const std::uint8_t * body_;
  std::size_t size_;
  std::size_t position_ = 0;

  const std::uint8_t * take(std::size_t size, std::size_t alignment)
  {
    const std::size_t start = aligned(position_, alignment);
    if (start > size_ || size > size_ - start) {return nullptr;}
    position_ = start + size;
    return body_ + start;
  }

  template<std::size_t position, class Type, class... Rest>
  static void get(const std::uint8_t * start, const char *, Type & value, Rest &&... rest)
  {
    constexpr std::size_t begin = aligned(position, Layout<Type>::alignment);
    load(start + begin, value);
    if constexpr (sizeof...(Rest) != 0) {get<begin + Layout<Type>::size>(start, rest...);}
  }

  template<class Type>
  static void load(const std::uint8_t * from, Type & value)
  {
    if constexpr (std::is_same_v<Type, bool>) {
      value = *from != 0;
    } else {
      std::memcpy(&value, from, sizeof(Type));
      if constexpr (swap) {Swapper::swap(value);}
    }
  }

  template<class Element, std::size_t count>
  static void load(const std::uint8_t * from, std::array<Element, count> & values)
  {
    if constexpr (std::is_same_v<Element, bool>) {
      for (bool & value : values) {value = *from++ != 0;}
    } else {
      std::memcpy(values.data(), from, count * sizeof(Element));
      if constexpr (swap) {Swapper::swap(values);}
    }
  }

  bool count(std::size_t & value)
  {
    const std::uint8_t * from = take(4, 4);
    if (from == nullptr) {return fail(too_short);}
    std::uint32_t number = 0;
    load(from, number);
    value = number;
    return true;
  }

  template<class Message>
  bool read(Message & message, Bound) {return Traits<Message>::fields(*this, message);}

  bool read(std::string & text, Bound bound)
  {
    std::size_t length = 0;
    if (!count(length)) {return false;}
    const std::uint8_t * from = take(length, 1);
    if (from == nullptr) {return fail("a string is longer than what is left of the payload");}
    const char * begin = reinterpret_cast<const char *>(from);
    if (length != 0 && begin[length - 1] == 0) {--length;}
    if (has_nul(begin, length)) {length = std::strlen(begin);}
    text.assign(begin, length);
    return !is_longer(text, bound.characters) || fail("a string is longer than its bound");
  }

  bool read(std::u16string & text, Bound bound)
  {
    std::size_t length = 0;
    if (!count(length)) {return false;}
    if (length > (size_ - position_) / 4) {
      return fail("a string is longer than what is left of the payload");
    }
    text.resize(length);
    const std::uint8_t * from = take(4 * length, 4);
    for (char16_t & unit : text) {
      std::uint32_t value = 0;
      load(from, value);
      if (value > 0xFFFFU) {return fail("a character of a wstring is no unit of UTF-16");}
      unit = static_cast<char16_t>(value);
      from += 4;
    }
    return !is_longer(text, bound.characters) || fail("a string is longer than its bound");
  }

  template<class Element>
  bool read(std::vector<Element> & values, Bound bound)
  {
    std::size_t length = 0;
    if (!count(length)) {return false;}
    if (length > bound.count) {return fail("a sequence has more elements than its bound");}
    if constexpr (is_plain<Element>) {
      constexpr std::size_t size = Layout<Element>::size;
      if (length == 0) {
        values.clear();
        return true;
      }
      const std::uint8_t * from = nullptr;
      if (length <= (size_ - position_) / size) {from = take(length * size, Layout<Element>::alignment);}
      if (from == nullptr) {return fail("a sequence is longer than what is left of the payload");}
      if constexpr (std::is_same_v<Element, std::uint8_t>) {
        values.assign(from, from + length);
      } else if constexpr (std::is_same_v<Element, bool>) {
        values.resize(length);
        for (std::size_t i = 0; i < length; ++i) {values[i] = from[i] != 0;}
      } else {
        values.resize(length);
        std::memcpy(values.data(), from, length * size);
        if constexpr (swap) {
          for (Element & value : values) {Swapper::swap(value);}
        }
      }
      return true;
    } else {
      if (length > (size_ - position_) / Smallest<Element>::size) {
        return fail("a sequence is longer than what is left of the payload");
      }
      values.resize(length);
      return read_all(values, bound);
    }
  }

  template<class Element, std::size_t size>
  bool read(std::array<Element, size> & values, Bound bound) {return read_all(values, bound);}

  template<class Values>
  bool read_all(Values & values, Bound bound)
  {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!read(values[i], bound)) {return within(i);}
    }
    return true;
  }
};

template<class Message>
inline void write(const Message & message, std::uint8_t * bytes)
{
  const std::uint8_t header[header_size] = {0, 1, 0, 0};
  std::memcpy(bytes, header, header_size);
  Writer writer(bytes + header_size);
  Traits<Message>::fields(writer, message);
}

}  // namespace detail

/// The bytes that `encode` makes, or 0 for a message that cannot be encoded.
template<class Message>
std::size_t encoded_size(const Message & message)
{
  detail::Sizer sizer;
  return Traits<Message>::fields(sizer, message) ? detail::header_size + sizer.position : 0;
}

/// Replaces `bytes` by the payload of the message, with its header. Leaves `bytes` alone if it fails.
template<class Message>
Status encode(const Message & message, std::vector<std::uint8_t> & bytes)
{
  detail::Sizer sizer;
  if (Traits<Message>::fields(sizer, message)) {
    bytes.resize(detail::header_size + sizer.position);
    detail::write(message, bytes.data());
  }
  return static_cast<Status &&>(sizer.status);
}

/// Writes the payload to memory of the caller. `written` becomes its size; nothing is written if that exceeds `room`.
template<class Message>
Status encode_into(const Message & message, std::uint8_t * bytes, std::size_t room, std::size_t & written)
{
  detail::Sizer sizer;
  written = 0;
  if (Traits<Message>::fields(sizer, message)) {
    written = detail::header_size + sizer.position;
    if (written <= room) {
      detail::write(message, bytes);
    } else {
      sizer.fail("the message needs more room");
    }
  }
  return static_cast<Status &&>(sizer.status);
}

/// Reads a payload of either byte order. What follows the message is ignored. After a failure, the message holds the
/// fields before the one at fault.
template<class Message>
Status decode(const std::uint8_t * bytes, std::size_t size, Message & message)
{
  if (size < detail::header_size) {return {"expected a header of 4 bytes", {}};}
  if (bytes[0] != 0 || bytes[1] > 1) {return {"expected plain CDR: a header 0000 or 0001", {}};}
  const std::uint8_t * body = bytes + detail::header_size;
  if ((bytes[1] == 0) == detail::big_endian_host) {
    detail::Reader<false> reader(body, size - detail::header_size);
    Traits<Message>::fields(reader, message);
    return static_cast<Status &&>(reader.status);
  }
  detail::Reader<true> reader(body, size - detail::header_size);
  Traits<Message>::fields(reader, message);
  return static_cast<Status &&>(reader.status);
}

template<class Message>
Status decode(const std::vector<std::uint8_t> & bytes, Message & message)
{
  return decode(bytes.data(), bytes.size(), message);
}

}  // namespace ifgen
