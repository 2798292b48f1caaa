#pragma once

namespace crosspatch {

/// While any of these lives, in whatever thread, OpenBLAS (when that is the BLAS linked) runs on
/// one thread: with more, the last digits of a supernodal factor depend on the number of threads,
/// and they compete with ours.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas();
  ~SingleThreadedBlas();
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  int levels_before_ = -1;  ///< of parallel regions of OpenMP; -1 without it
};

}  // namespace crosspatch
