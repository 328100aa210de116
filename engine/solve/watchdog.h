// Steps that a merit refuses and that are taken all the same, until one more step has shown where they lead
// (the watchdog technique of Chamberlain, Powell, Lemarechal & Pedersen 1982): what should turn was stretched
// on the tangent, stiff parts charge for that, and the next step takes it back.
//
// Such steps that fail are followed by shorter ones, and three more failures than successes, or one that
// leaves the domain of the energies, end them for a solve. A long way needs several steps back; they go on
// while each takes most of what is left to pay.
#pragma once

#include <algorithm>

namespace isochor {

class Watchdog {
 public:
  bool watching() const { return watching_; }
  bool may_begin() const { return !watching_ && failed_ < most_failed; }
  // Part of a whole step that is taken.
  double length() const { return length_; }

  // A step was taken that ends `excess` above the merit that it had to reach.
  void begin(double enough, double excess) {
    watching_ = true;
    returns_ = 0;
    enough_ = enough;
    excess_ = excess;
  }

  enum class Outcome {
    reached,     // what the step had to reach
    on_its_way,  // most of the excess is gone: one more step
    failed       // back to where it began
  };
  // Of the merit behind one more step.
  Outcome judge(double value) {
    constexpr double little = 0.2;
    const double left = value - enough_;
    if (value > enough_ && left < little * excess_ && ++returns_ < most_returns) {
      excess_ = left;
      return Outcome::on_its_way;
    }
    watching_ = false;
    if (value <= enough_) {
      failed_ = std::max(0, failed_ - 1);
      length_ = std::min(1.0, 1.5 * length_);
      return Outcome::reached;
    }
    ++failed_;
    length_ *= 0.4;
    return Outcome::failed;
  }

 private:
  static constexpr int most_failed = 3, most_returns = 4;
  bool watching_ = false;
  int failed_ = 0;   // in this solve, less those that went well
  int returns_ = 0;  // steps back so far
  double length_ = 1;
  double enough_ = 0, excess_ = 0;
};

}  // namespace isochor
