// Adds the time of its scope to a sum, s.
#pragma once

#include <mpi.h>

namespace motley {

class Stopwatch {
  public:
    explicit Stopwatch(double& sum) : sum_(sum), began_(MPI_Wtime()) {}
    ~Stopwatch() { sum_ += MPI_Wtime() - began_; }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    double& sum_;
    double began_;
};

}  // namespace motley
