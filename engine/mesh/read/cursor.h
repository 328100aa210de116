// Reading position in a file held in memory: words, numbers and raw bytes, each with bounds and a place to
// name.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "engine/mesh/words.h"

namespace isochor::mesh_files {

// Thrown by readers and caught by read_mesh only: a parser has too many ways to fail for a status at each
// call.
struct ReadFailure {
  std::string message;
};

class Cursor {
 public:
  Cursor(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  // In binary parts places are byte offsets, in text parts lines.
  void set_binary(bool binary) { binary_ = binary; }
  void set_swapped(bool swapped) { swapped_ = swapped; }
  void set_section(std::string section) { section_ = std::move(section); }
  bool binary() const { return binary_; }
  const std::string& file() const { return file_; }

  std::size_t offset() const { return at_; }
  void move_to(std::size_t offset) { at_ = offset < text_.size() ? offset : text_.size(); }
  std::size_t left() const { return text_.size() - at_; }
  std::string_view rest() const { return text_.substr(at_); }
  bool at_end() const { return at_ >= text_.size(); }

  void skip_space();
  // Skips spaces and comments from '#' to the end of the line.
  void skip_space_and_comments();
  // The next word, and "" at the end of the file. Does not move: what looks like space may be binary data.
  std::string_view peek_word() const;
  // The next word; `what` says what was expected when the file ends instead.
  std::string_view word(const char* what);
  std::int64_t integer(const char* what);
  // A finite number.
  double real(const char* what);
  // A number that may be NaN or infinite: field values, which check_mesh judges.
  double any_real(const char* what);
  // What is left of the current line, without its end.
  std::string_view line(const char* what);
  // Text between double quotes.
  std::string_view quoted_text(const char* what);
  // Moves behind the first occurrence of `mark`; false if there is none.
  bool skip_past(std::string_view mark);

  std::string_view bytes(std::size_t count, const char* what);
  template <class T>
  T raw(const char* what) {
    T value;
    const std::string_view b = bytes(sizeof(T), what);
    if (swapped_) {
      char turned[sizeof(T)];
      for (std::size_t i = 0; i < sizeof(T); ++i) turned[i] = b[sizeof(T) - 1 - i];
      std::memcpy(&value, turned, sizeof(T));
    } else {
      std::memcpy(&value, b.data(), sizeof(T));
    }
    return value;
  }
  double raw_finite(const char* what);

  // Refuses a count that is negative, does not fit Index, or promises more than the rest of the file can
  // hold, so that nothing is allocated on the word of a broken header.
  std::size_t checked_count(std::int64_t count, std::size_t least_bytes_each, const char* what) const;

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;
  std::string place() const;
  // From here on failures name the section only: for checks after the reading, when the position says
  // nothing.
  void forget_place() { token_ = std::string_view::npos; }

 private:
  template <class T>
  T number(const char* what, const char* kind);

  std::string_view text_;
  std::string file_, section_;
  std::size_t at_ = 0;
  std::size_t token_ = 0;  // start of the last token, for the place of a failure
  bool binary_ = false, swapped_ = false;
};

// Repeated remedy for files that end early or contradict themselves.
inline constexpr const char* rewrite_file = "the file is damaged or truncated: export or copy it again";

}  // namespace isochor::mesh_files
