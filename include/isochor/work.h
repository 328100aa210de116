// What solving took: counters and seconds, the same from the solver to the report of a step and of a run.
#pragma once

#include <cstdint>

namespace isochor {

// Of methods that ascend on multipliers.
struct DualCounters {
  int steps = 0;                // of dual ascent
  int stand_ins = 0;            // increments left to Method::augmented_gradients or saddle_point
  std::int64_t iterations = 0;  // of conjugate gradients on multipliers

  DualCounters& operator+=(const DualCounters& o) {
    steps += o.steps;
    stand_ins += o.stand_ins;
    iterations += o.iterations;
    return *this;
  }
};

// Of Solver::iterative.
struct KrylovCounters {
  std::int64_t iterations = 0;  // for directions

  KrylovCounters& operator+=(const KrylovCounters& o) {
    iterations += o.iterations;
    return *this;
  }
};

struct SolveCounters {
  // Of Newton iterations, which are part of every method.
  int iterations = 0;              // each with its own factorization
  int corrections = 0;             // further steps on factors at hand
  int lagged = 0;                  // FrictionCoupling::coupled: iterations that fell back to lagged friction
  int factorizations = 0;          // mending an inertia takes more than one an iteration
  int trials = 0;                  // evaluations of line searches
  int projected = 0, shifted = 0;  // iterations whose matrix had to be mended: by projection, by a shift
  DualCounters dual;
  KrylovCounters krylov;

  int solves() const { return iterations + corrections; }  // with the factors of an iteration

  SolveCounters& operator+=(const SolveCounters& o) {
    iterations += o.iterations;
    corrections += o.corrections;
    lagged += o.lagged;
    factorizations += o.factorizations;
    trials += o.trials;
    projected += o.projected;
    shifted += o.shifted;
    dual += o.dual;
    krylov += o.krylov;
    return *this;
  }
};

// Seconds by stage of the work done.
struct StageSeconds {
  double analyze = 0, evaluate = 0, gather = 0, factor = 0, solve = 0, line_search = 0;
  double total = 0;  // of whole steps, with what is between the stages

  StageSeconds& operator+=(const StageSeconds& o) { return add(1, o); }
  StageSeconds& operator-=(const StageSeconds& o) { return add(-1, o); }

 private:
  StageSeconds& add(double sign, const StageSeconds& o) {
    analyze += sign * o.analyze;
    evaluate += sign * o.evaluate;
    gather += sign * o.gather;
    factor += sign * o.factor;
    solve += sign * o.solve;
    line_search += sign * o.line_search;
    total += sign * o.total;
    return *this;
  }
};

}  // namespace isochor
