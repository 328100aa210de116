#include "engine/mesh/read/cursor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/chars.h"

namespace isochor::mesh_files {

namespace {

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

void Cursor::skip_space() {
  while (at_ < text_.size() && is_space(text_[at_])) ++at_;
}

void Cursor::skip_space_and_comments() {
  skip_space();
  while (at_ < text_.size() && text_[at_] == '#') {
    at_ = std::min(text_.find('\n', at_), text_.size());
    skip_space();
  }
}

std::string_view Cursor::peek_word() const {
  std::size_t begin = at_;
  while (begin < text_.size() && is_space(text_[begin])) ++begin;
  std::size_t end = begin;
  while (end < text_.size() && !is_space(text_[end])) ++end;
  return text_.substr(begin, end - begin);
}

std::string_view Cursor::word(const char* what) {
  skip_space();
  token_ = at_;
  const std::string_view w = peek_word();
  if (w.empty()) fail(join("the file ends where ", what, " was expected"), rewrite_file);
  at_ += w.size();
  return w;
}

template <class T>
T Cursor::number(const char* what, const char* kind) {
  skip_space();
  token_ = at_;
  if (at_ >= text_.size()) fail(join("the file ends where ", what, " was expected"), rewrite_file);
  const char* first = text_.data() + at_;
  const char* last = text_.data() + text_.size();
  // from_chars takes no plus sign, but some exporters write one.
  if (*first == '+' && first + 1 < last && first[1] != '-') ++first;
  T value{};
  const auto [end, status] = isochor::from_chars(first, last, value);
  if (status != std::errc() || (end < last && !is_space(*end))) {
    fail(join(what, " should be ", kind, " but reads ", quoted(peek_word())), rewrite_file);
  }
  at_ = static_cast<std::size_t>(end - text_.data());
  return value;
}

std::int64_t Cursor::integer(const char* what) {
  return number<std::int64_t>(what, "a whole number");
}

double Cursor::any_real(const char* what) {
  return number<double>(what, "a number");
}

double Cursor::real(const char* what) {
  const double value = any_real(what);
  if (!std::isfinite(value)) {
    fail(join(what, " is ", value), "coordinates must be finite: repair the file");
  }
  return value;
}

double Cursor::raw_finite(const char* what) {
  const double value = raw<double>(what);
  if (!std::isfinite(value)) {
    fail(join(what, " is ", value), "coordinates must be finite: repair the file");
  }
  return value;
}

std::string_view Cursor::line(const char* what) {
  token_ = at_;
  if (at_ >= text_.size()) fail(join("the file ends where ", what, " was expected"), rewrite_file);
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view found = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
  return found;
}

std::string_view Cursor::quoted_text(const char* what) {
  skip_space();
  token_ = at_;
  const std::size_t close = at_ < text_.size() && text_[at_] == '"' ? text_.find('"', at_ + 1) : text_.npos;
  if (close == text_.npos) {
    fail(join(what, " should be in double quotes but reads ", quoted(peek_word())), rewrite_file);
  }
  const std::string_view found = text_.substr(at_ + 1, close - at_ - 1);
  at_ = close + 1;
  return found;
}

bool Cursor::skip_past(std::string_view mark) {
  const std::size_t found = text_.find(mark, at_);
  if (found == text_.npos) return false;
  at_ = found + mark.size();
  return true;
}

std::string_view Cursor::bytes(std::size_t count, const char* what) {
  token_ = at_;
  if (count > left()) {
    fail(join(what, " needs ", count, " bytes but only ", left(), " are left"), rewrite_file);
  }
  const std::string_view found = text_.substr(at_, count);
  at_ += count;
  return found;
}

std::size_t Cursor::checked_count(std::int64_t count, std::size_t least_bytes_each, const char* what) const {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  if (count < 0) fail(join(what, " is ", count, ", a negative number"), rewrite_file);
  if (count > most) fail(join(what, " is ", count, ", more than ", most), "no mesh that large can be read");
  if (static_cast<std::size_t>(count) > (left() + 1) / least_bytes_each) {
    fail(join(what, " is ", count, " but only ", left(), " bytes follow"), rewrite_file);
  }
  return static_cast<std::size_t>(count);
}

std::string Cursor::place() const {
  if (token_ == std::string_view::npos) return section_;
  const std::string where = section_.empty() ? std::string() : join(" in ", section_);
  if (binary_) return join("byte ", token_, where);
  // Lines are counted only here, so that reading pays nothing for them.
  const std::size_t until = std::min(token_, text_.size());
  const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(until), '\n');
  return join("line ", lines + 1, where);
}

void Cursor::fail(const std::string& problem, const std::string& remedy) const {
  const std::string where = place();
  throw ReadFailure{join(file_, where.empty() ? "" : ", ", where, ": ", problem, "; ", remedy)};
}

}  // namespace isochor::mesh_files
