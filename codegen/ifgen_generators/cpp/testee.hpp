// The testee of the conformance suite for C++: docs/conformance.md of ifgen has the protocol.
#pragma once

#include <chrono>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "ifgen/cdr.hpp"

namespace ifgen::testee
{

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::string>;

/// `ok DATA`, `refused WORDS`, `skip FEATURE` or `fail WORDS`.
struct Reply
{
  const char * kind;
  std::string text;
};

struct Type
{
  const char * hash;
  Reply (* answer)(const std::string & operation, const Words & arguments);
  std::map<std::string, std::string> constants;
};

using Types = std::map<std::string, Type>;

inline std::string hex(std::uint64_t value, std::size_t digits)
{
  std::string text(digits, '0');
  for (std::size_t i = digits; i-- > 0; value >>= 4) {text[i] = "0123456789abcdef"[value & 15];}
  return text;
}

inline std::string hex(const Bytes & bytes)
{
  std::string text;
  for (const std::uint8_t byte : bytes) {text += hex(byte, 2);}
  return text;
}

inline std::uint64_t number_of(const std::string & digits) {return std::stoull("0" + digits, nullptr, 16);}

inline Bytes bytes_of(const std::string & digits)
{
  Bytes bytes;
  for (std::size_t i = 0; digits != "-" && i + 1 < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(number_of(digits.substr(i, 2))));
  }
  return bytes;
}

template<class Float>
using Bits = std::conditional_t<sizeof(Float) == 4, std::uint32_t, std::uint64_t>;

/// One value of the canonical text.
template<class Value>
std::string text_of(const Value & value)
{
  if constexpr (std::is_same_v<Value, std::string>) {
    return hex(Bytes(value.begin(), value.end()));
  } else if constexpr (std::is_same_v<Value, std::u16string>) {
    std::string text;
    for (const char16_t unit : value) {text += hex(unit, 4);}
    return text;
  } else if constexpr (std::is_floating_point_v<Value>) {
    Bits<Value> bits;
    std::memcpy(&bits, &value, sizeof bits);
    return hex(bits, 2 * sizeof bits);
  } else {
    return std::to_string(value);
  }
}

template<class Value>
void read_text(const std::string & text, Value & value)
{
  if constexpr (std::is_same_v<Value, std::string>) {
    const Bytes bytes = bytes_of(text);
    value.assign(bytes.begin(), bytes.end());
  } else if constexpr (std::is_same_v<Value, std::u16string>) {
    value.clear();
    for (std::size_t i = 0; i < text.size(); i += 4) {
      value.push_back(static_cast<char16_t>(number_of(text.substr(i, 4))));
    }
  } else if constexpr (std::is_floating_point_v<Value>) {
    const auto bits = static_cast<Bits<Value>>(number_of(text));
    std::memcpy(&value, &bits, sizeof bits);
  } else if constexpr (std::is_unsigned_v<Value>) {
    value = static_cast<Value>(std::stoull(text));
  } else {
    value = static_cast<Value>(std::stoll(text));
  }
}

template<class Value>
inline constexpr bool is_leaf = std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string> ||
  std::is_same_v<Value, std::u16string>;

/// The path of a field. Not templates: each of hundreds of types would compile them again.
class Path
{
public:
  std::string text{};

  std::size_t push(const char * name)
  {
    const std::size_t outer = text.size();
    if (outer != 0) {text += '.';}
    text += name;
    return outer;
  }

  std::size_t push(std::size_t index)
  {
    const std::size_t outer = text.size();
    text += "[" + std::to_string(index) + "]";
    return outer;
  }

  void pop(std::size_t outer) {text.resize(outer);}
};

/// Visits all leaves of a message. A Visitor has `leaf(path, value)` and `count(path, sequence)`.
template<class Visitor>
class Walk
{
public:
  explicit Walk(Visitor & visitor)
  : visitor_(visitor) {}

  template<class Value, class... Rest>
  bool run(const char * name, Value & value, Rest &&... rest)
  {
    const std::size_t outer = path_.push(name);
    visit(value);
    path_.pop(outer);
    if constexpr (sizeof...(Rest) != 0) {run(rest...);}
    return true;
  }

  template<class Value>
  bool field(const char * name, Value & value, Bound = {}) {return run(name, value);}

  bool placeholder() {return true;}

private:
  Visitor & visitor_;
  Path path_;

  template<class Value>
  void visit(Value & value)
  {
    if constexpr (is_leaf<std::remove_const_t<Value>>) {
      visitor_.leaf(path_.text, value);
    } else {
      Traits<std::remove_const_t<Value>>::fields(*this, value);
    }
  }

  template<class Element, std::size_t size>
  void visit(std::array<Element, size> & values) {visit_all(values);}

  template<class Element>
  void visit(std::vector<Element> & values)
  {
    visitor_.count(path_.text, values);
    visit_all(values);
  }

  template<class Values>
  void visit_all(Values & values)
  {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t outer = path_.push(i);
      visit(values[i]);
      path_.pop(outer);
    }
  }

  void visit_all(std::vector<bool> & values)
  {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t outer = path_.push(i);
      bool value = values[i];
      visit(value);
      values[i] = value;
      path_.pop(outer);
    }
  }
};

class Dumper
{
public:
  std::string text{};

  template<class Value>
  void leaf(const std::string & path, const Value & value) {add(path, text_of(value));}

  template<class Values>
  void count(const std::string & path, const Values & values) {add(path + "#", std::to_string(values.size()));}

private:
  void add(const std::string & path, const std::string & value)
  {
    if (!text.empty()) {text += ' ';}
    text += path + "=" + value;
  }
};

/// Takes the values of a canonical text in their order, and compares the paths.
class Loader
{
public:
  std::string problem{};

  explicit Loader(const Words & words)
  : words_(words) {}

  template<class Value>
  void leaf(const std::string & path, Value & value)
  {
    const std::string text = value_of(path);
    if (problem.empty()) {read_text(text, value);}
  }

  template<class Values>
  void count(const std::string & path, Values & values) {values.resize(count_of(path));}

private:
  const Words & words_;
  std::size_t next_ = 0;

  std::string value_of(const std::string & path)
  {
    const std::string word = next_ < words_.size() ? words_[next_] : "the end of the text";
    ++next_;
    if (word.compare(0, path.size() + 1, path + "=") == 0) {return word.substr(path.size() + 1);}
    problem = "expected " + path + ", got " + word;
    return "";
  }

  std::size_t count_of(const std::string & path)
  {
    const std::string text = value_of(path + "#");
    const std::size_t count = problem.empty() ? std::stoul(text) : 0;
    if (count <= 1000000) {return count;}
    problem = "a count is too large for a test";
    return 0;
  }
};

template<class Call>
std::string nanoseconds(std::size_t count, Call call)
{
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < count; ++i) {call();}
  const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
  return std::to_string(time.count() / static_cast<double>(count == 0 ? 1 : count));
}

inline Reply refused(const Status & status) {return {"refused", status.text()};}

template<class Message>
Reply encoded(const Message & message)
{
  Bytes bytes;
  const Status status = encode(message, bytes);
  return status ? Reply{"ok", hex(bytes)} : refused(status);
}

template<class Message>
Reply answer(const std::string & operation, const Words & arguments)
{
  Message message;
  if (operation == "default") {return encoded(message);}
  if (operation == "load") {
    Loader loader(arguments);
    Walk<Loader> walk(loader);
    Traits<Message>::fields(walk, message);
    return loader.problem.empty() ? encoded(message) : Reply{"refused", loader.problem};
  }
  if (arguments.empty()) {return {"fail", "expected a payload"};}
  const Bytes bytes = bytes_of(arguments[0]);
  const Status status = decode(bytes, message);
  if (!status) {return refused(status);}
  if (operation == "recode") {return encoded(message);}
  if (operation == "size") {return {"ok", std::to_string(encoded_size(message))};}
  if (operation == "dump") {
    Dumper dumper;
    Walk<Dumper> walk(dumper);
    Traits<Message>::fields(walk, message);
    return {"ok", dumper.text};
  }
  if (operation == "equal") {
    Message other;
    const Status second = decode(bytes_of(arguments.at(1)), other);
    return second ? Reply{"ok", message == other ? "1" : "0"} : refused(second);
  }
  if (operation == "bench") {
    const std::size_t count = std::stoul(arguments.at(1));
    Bytes written;
    const std::string encoding = nanoseconds(count, [&] {static_cast<void>(encode(message, written));});
    const std::string decoding = nanoseconds(count, [&] {static_cast<void>(decode(bytes, message));});
    return {"ok", encoding + " " + decoding};
  }
  return {"skip", operation};
}

inline Reply reply(const Types & types, const Words & words)
{
  const std::string & operation = words[0];
  if (operation == "hello") {return {"ok", "protocol=1 language=cpp library=ifgen"};}
  const auto type = types.find(words[2]);
  if (type == types.end()) {return {"skip", "unknown-type"};}
  if (operation == "hash") {return {"ok", type->second.hash};}
  const Words arguments(words.begin() + 3, words.end());
  if (operation == "constant") {
    const auto constant = type->second.constants.find(arguments.at(0));
    return constant == type->second.constants.end() ? Reply{"fail", "no such constant"} : Reply{"ok", constant->second};
  }
  return type->second.answer == nullptr ? Reply{"skip", operation} : type->second.answer(operation, arguments);
}

/// Answers the lines of standard input until it ends.
inline int main(const Types & types)
{
  std::string line;
  for (int character = std::getchar(); character != EOF; character = std::getchar()) {
    if (character != '\n') {
      line += static_cast<char>(character);
      continue;
    }
    std::istringstream stream(line);
    Words words;
    for (std::string word; stream >> word; ) {words.push_back(word);}
    line.clear();
    if (words.size() < 3) {continue;}
    const Reply answer = reply(types, words);
    std::printf("%s %s %s\n", answer.kind, words[1].c_str(), answer.text.c_str());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace ifgen::testee
