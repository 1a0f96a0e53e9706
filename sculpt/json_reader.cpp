#include "sculpt/json_reader.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "implicit/errors.h"

namespace restroke::sculpt {

using nlohmann::json;

namespace {

// The library's own builder of values accepts a key that occurs twice and any depth; this one does not.
class StrictBuilder : public nlohmann::json_sax<json> {
 public:
  StrictBuilder(std::string_view text, const TextOrigin& origin) : text_(text), origin_(origin) {}

  bool null() override { return put(json(nullptr)); }
  bool boolean(bool value) override { return put(json(value)); }
  bool number_integer(number_integer_t value) override { return put(json(value)); }
  bool number_unsigned(number_unsigned_t value) override { return put(json(value)); }
  bool number_float(number_float_t value, const string_t&) override { return put(json(value)); }
  bool string(string_t& value) override { return put(json(std::move(value))); }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (open_.back().value.contains(name))
      return fail(
          fmt::format("key \"{}\" occurs twice in one object, but must occur once", name.substr(0, 40)));
    open_.back().key = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // The position counts bytes read, so the offending one is the last of them.
    const std::size_t at = std::min(position == 0 ? 0 : position - 1, text_.size());
    const std::string_view before = text_.substr(0, at);
    origin_.line += static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
    const std::size_t lineStart = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow)
      return fail(
          fmt::format("the number that ends at byte {} overflows, but must fit in a double", at - lineStart));
    if (at >= text_.size())
      return fail("the text ends in the middle of a JSON value, but must hold a whole one");
    return fail(fmt::format("byte {} of the line is not valid JSON (NaN and Infinity are not either)",
                            at - lineStart + 1));
  }

  [[nodiscard]] json take() { return std::move(result_); }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  struct Open {
    json value;
    std::string key;
  };

  bool fail(const std::string& what) {
    error_ = fmt::format("{}:{}: {}", origin_.file, origin_.line, what);
    return false;
  }
  bool put(json&& value) {
    if (open_.empty())
      result_ = std::move(value);
    else if (open_.back().value.is_array())
      open_.back().value.push_back(std::move(value));
    else
      open_.back().value[std::move(open_.back().key)] = std::move(value);
    return true;
  }
  bool open(json&& value) {
    if (open_.size() == kMaxJsonDepth)
      return fail(fmt::format("JSON is nested deeper than {} levels", kMaxJsonDepth));
    open_.push_back({std::move(value), {}});
    return true;
  }
  bool close() {
    json value = std::move(open_.back().value);
    open_.pop_back();
    return put(std::move(value));
  }

  std::string_view text_;
  TextOrigin origin_;
  std::vector<Open> open_;
  json result_;
  std::string error_;
};

}  // namespace

json parseJson(std::string_view text, const TextOrigin& origin) {
  StrictBuilder builder(text, origin);
  if (!json::sax_parse(text.begin(), text.end(), &builder)) throw InputError(builder.error());
  return builder.take();
}

std::string describe(const json& value) {
  switch (value.type()) {
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return fmt::format("an array of {}", value.size());
    case json::value_t::string: {
      std::string text = value.get_ref<const std::string&>();
      const bool cut = text.size() > 40;
      if (cut) text.resize(40);
      // A sentence is one line of plain text, whatever the file holds.
      for (char& c : text)
        if (c >= 0 && (c < ' ' || c == 127)) c = '?';
      return fmt::format("\"{}{}\"", text, cut ? "..." : "");
    }
    default:
      return value.dump();
  }
}

JsonField::JsonField(const json& value, std::string where, std::string path)
    : value_(&value), where_(std::move(where)), path_(std::move(path)) {}

void JsonField::refuse(std::string_view rule) const {
  throw InputError(fmt::format("{}: {} is {}, but must be {}", where_, path_.empty() ? "the text" : path_,
                               describe(*value_), rule));
}

void JsonField::requireKeysAmong(std::initializer_list<const char*> keys) const {
  if (!value_->is_object()) refuse("an object");
  for (const auto& [key, unused] : value_->items()) {
    if (std::any_of(keys.begin(), keys.end(), [&](const char* known) { return key == known; })) continue;
    std::string list;
    for (const char* known : keys) list += fmt::format("{}{}", list.empty() ? "" : ", ", known);
    throw InputError(fmt::format("{}: {}{} is not a known key, but keys must be among {}", where_,
                                 path_.empty() ? "" : path_ + ": ", describe(json(key)),
                                 list.empty() ? "none" : list));
  }
}

bool JsonField::has(const char* key) const {
  return value_->is_object() && value_->contains(key);
}

JsonField JsonField::member(const char* key) const {
  if (!value_->is_object()) refuse("an object");
  const auto found = value_->find(key);
  if (found == value_->end())
    throw InputError(fmt::format("{}: {}{} is missing", where_, path_.empty() ? "" : path_ + ".", key));
  return {*found, where_, path_.empty() ? key : path_ + "." + key};
}

std::size_t JsonField::arraySize() const {
  if (!value_->is_array()) refuse("an array");
  return value_->size();
}

JsonField JsonField::element(std::size_t index) const {
  return {(*value_)[index], where_, fmt::format("{}[{}]", path_, index)};
}

double JsonField::number(const NumberRange& range) const {
  if (!value_->is_number()) refuse(range.rule);
  const double number = value_->get<double>();
  if (!std::isfinite(number) || !(number >= range.min && number <= range.max)) refuse(range.rule);
  return number;
}

float JsonField::number32(const NumberRange& range) const {
  const double wide = number(range);
  const auto narrow = static_cast<float>(wide);
  if (!std::isfinite(narrow) || !(narrow >= range.min && narrow <= range.max)) refuse(range.rule);
  return narrow;
}

std::int64_t JsonField::integer(const NumberRange& range) const {
  if (!value_->is_number_integer()) refuse(range.rule);
  // Unsigned values beyond int64 would wrap: compare them as doubles first.
  const double wide = value_->get<double>();
  if (!(wide >= range.min && wide <= range.max)) refuse(range.rule);
  return value_->get<std::int64_t>();
}

std::string JsonField::string() const {
  if (!value_->is_string()) refuse("a string");
  return value_->get<std::string>();
}

}  // namespace restroke::sculpt
