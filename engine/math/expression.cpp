// Recursive descent: a sum of products of signed powers of what is single. Each part appends its actions, so
// that the program is in the order in which a stack takes it.
#include "engine/math/expression.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

namespace isochor {

namespace {

using Do = Expression::Do;

// Of the stack, and of brackets within brackets, which the parser follows by calling itself.
constexpr std::size_t kMostNumbers = 32;
constexpr int kMostDepth = 100;

struct Function {
  const char* name;
  Do what;
  int arguments;
};
constexpr Function kFunctions[] = {{"abs", Do::abs, 1}, {"sqrt", Do::sqrt, 1}, {"exp", Do::exp, 1},
                                   {"log", Do::log, 1}, {"sin", Do::sin, 1},   {"cos", Do::cos, 1},
                                   {"tan", Do::tan, 1}, {"tanh", Do::tanh, 1}, {"step", Do::step, 1},
                                   {"min", Do::min, 2}, {"max", Do::max, 2},   {"atan2", Do::atan2, 2}};

// Numbers that an action takes off the stack; each puts one there.
std::size_t taken(Do what) {
  switch (what) {
    case Do::number:
    case Do::x:
    case Do::y:
    case Do::z:
    case Do::t:
      return 0;
    case Do::add:
    case Do::subtract:
    case Do::multiply:
    case Do::divide:
    case Do::power:
    case Do::atan2:
    case Do::min:
    case Do::max:
      return 2;
    default:
      return 1;
  }
}

class Parser {
 public:
  explicit Parser(const std::string& text) : text_(text) {}

  Result<std::vector<Expression::Action>> parse() {
    sum();
    skip();
    if (error_.empty() && at_ < text_.size()) fail("expected an operator or the end");
    std::size_t height = 0, most = 0;
    for (const Expression::Action& a : actions_) {
      height += 1 - taken(a.what);
      most = std::max(most, height);
    }
    if (error_.empty() && most > kMostNumbers) error_ = "it is nested too deeply; write it in a simpler way";
    if (!error_.empty()) return Error{error_};
    return std::move(actions_);
  }

 private:
  char skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (!error_.empty() || skip() != c) return false;
    ++at_;
    return true;
  }
  void fail(const std::string& why) {
    if (error_.empty()) error_ = why + " at character " + std::to_string(at_ + 1);
  }
  void put(Do what, double number = 0) { actions_.push_back({what, number}); }

  void sum() {
    if (++depth_ > kMostDepth) return fail("brackets are nested too deeply");
    product();
    while (error_.empty()) {
      if (take('+')) {
        product();
        put(Do::add);
      } else if (take('-')) {
        product();
        put(Do::subtract);
      } else {
        break;
      }
    }
    --depth_;
  }
  void product() {
    signed_power();
    while (error_.empty()) {
      if (take('*')) {
        signed_power();
        put(Do::multiply);
      } else if (take('/')) {
        signed_power();
        put(Do::divide);
      } else {
        return;
      }
    }
  }
  // -x^2 is -(x^2), and x^-2 is x^(-2).
  void signed_power() {
    if (++depth_ > kMostDepth) return fail("signs and powers are nested too deeply");
    if (take('-')) {
      signed_power();
      put(Do::negate);
    } else if (take('+')) {
      signed_power();
    } else {
      single();
      if (take('^')) {
        signed_power();
        put(Do::power);
      }
    }
    --depth_;
  }
  void single() {
    if (!error_.empty()) return;
    const char c = skip();
    if (take('(')) {
      sum();
      if (!take(')')) fail("expected \")\"");
    } else if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.') {
      double v = 0;
      const auto [end, code] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), v);
      if (code != std::errc()) return fail("expected a number");
      at_ = static_cast<std::size_t>(end - text_.data());
      put(Do::number, v);
    } else if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word();
    } else {
      fail("expected a number, x, y, z, t, a function or a bracket");
    }
  }
  void word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && std::isalnum(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    const std::string name = text_.substr(begin, at_ - begin);
    constexpr std::pair<const char*, Do> variables[] = {
        {"x", Do::x}, {"y", Do::y}, {"z", Do::z}, {"t", Do::t}};
    for (const auto& [variable, what] : variables) {
      if (name == variable) return put(what);
    }
    if (name == "pi") return put(Do::number, std::numbers::pi);
    for (const Function& f : kFunctions) {
      if (name == f.name) return call(f);
    }
    at_ = begin;
    fail(std::string(1, '"').append(name, 0, 40) +
         "\" is not known; there are x, y, z, t, pi, abs, sqrt, exp, log, sin, cos, tan, tanh, step, "
         "min, max and atan2:");
  }
  void call(const Function& f) {
    if (!take('(')) return fail(std::string("expected \"(\" after ") + f.name);
    for (int k = 0; k < f.arguments; ++k) {
      if (k > 0 && !take(','))
        return fail(std::string("expected \",\": ") + f.name + " takes two arguments,");
      sum();
    }
    if (!take(')')) return fail("expected \")\"");
    put(f.what);
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::string error_;
  std::vector<Expression::Action> actions_;
};

double of_one(Do what, double v) {
  switch (what) {
    case Do::negate:
      return -v;
    case Do::abs:
      return std::abs(v);
    case Do::sqrt:
      return std::sqrt(v);
    case Do::exp:
      return std::exp(v);
    case Do::log:
      return std::log(v);
    case Do::sin:
      return std::sin(v);
    case Do::cos:
      return std::cos(v);
    case Do::tan:
      return std::tan(v);
    case Do::tanh:
      return std::tanh(v);
    default:
      return v >= 0 ? 1 : 0;
  }
}

double of_two(Do what, double a, double b) {
  switch (what) {
    case Do::add:
      return a + b;
    case Do::subtract:
      return a - b;
    case Do::multiply:
      return a * b;
    case Do::divide:
      return a / b;
    case Do::power:
      return std::pow(a, b);
    case Do::atan2:
      return std::atan2(a, b);
    case Do::min:
      return std::min(a, b);
    default:
      return std::max(a, b);
  }
}

}  // namespace

Result<Expression> Expression::parse(const std::string& text) {
  auto actions = Parser(text).parse();
  if (!actions) return actions.failure();
  Expression made;
  made.actions_ = std::move(actions).value();
  return made;
}

bool Expression::depends_on_time() const {
  return std::any_of(actions_.begin(), actions_.end(), [](const Action& a) { return a.what == Do::t; });
}

double Expression::operator()(const Vec3& x, double t) const {
  std::array<double, kMostNumbers> stack;
  std::size_t n = 0;
  for (const Action& a : actions_) {
    switch (a.what) {
      case Do::number:
        stack[n++] = a.number;
        break;
      case Do::x:
        stack[n++] = x.x;
        break;
      case Do::y:
        stack[n++] = x.y;
        break;
      case Do::z:
        stack[n++] = x.z;
        break;
      case Do::t:
        stack[n++] = t;
        break;
      default:
        if (taken(a.what) == 1) {
          stack[n - 1] = of_one(a.what, stack[n - 1]);
        } else {
          --n;
          stack[n - 1] = of_two(a.what, stack[n - 1], stack[n]);
        }
    }
  }
  return stack[0];
}

}  // namespace isochor
