#include "core/blas.hpp"

#include <mutex>

// Weak: other BLAS libraries do not have them, and need not.
extern "C" {
[[gnu::weak]] void openblas_set_num_threads(int);
[[gnu::weak]] int openblas_get_num_threads();
[[gnu::weak]] void omp_set_max_active_levels(int);
[[gnu::weak]] int omp_get_max_active_levels();
}

namespace crosspatch {

namespace {

std::mutex mutex;
int alive = 0;   // guards
int before = 0;  // threads when there was none

}  // namespace

SingleThreadedBlas::SingleThreadedBlas() {
  if (omp_get_max_active_levels != nullptr && omp_set_max_active_levels != nullptr) {
    levels_before_ = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
  }
  if (openblas_get_num_threads == nullptr || openblas_set_num_threads == nullptr) return;
  const std::lock_guard lock(mutex);
  if (alive++ > 0) return;
  before = openblas_get_num_threads();
  openblas_set_num_threads(1);
}

SingleThreadedBlas::~SingleThreadedBlas() {
  if (levels_before_ >= 0) omp_set_max_active_levels(levels_before_);
  if (openblas_get_num_threads == nullptr || openblas_set_num_threads == nullptr) return;
  const std::lock_guard lock(mutex);
  if (--alive == 0) openblas_set_num_threads(before);
}

}  // namespace crosspatch
