#include "tools/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace crosspatch {
namespace {

using std::size_t;
using std::uint32_t;
using std::uint64_t;

/// The first 32 bits of the fractions of the first primes' roots (sections 4.2.2 and 5.3.3). The
/// roots are below 2^5, so that doubles leave 16 bits beyond those taken; the published test
/// vectors confirm every constant.
template <size_t count>
std::array<uint32_t, count> prime_roots(double root(double)) {
  const auto is_prime = [](int n) {
    for (int d = 2; d * d <= n; ++d)
      if (n % d == 0) return false;
    return true;
  };
  std::array<uint32_t, count> roots{};
  int p = 1;
  for (uint32_t& bits : roots) {
    do {
      ++p;
    } while (!is_prime(p));
    const double value = root(p);
    bits = static_cast<uint32_t>((value - std::floor(value)) * 4294967296.0);
  }
  return roots;
}

using State = std::array<uint32_t, 8>;

void add_block(State& state, const unsigned char* block) {
  static const std::array<uint32_t, 64> constants =
      prime_roots<64>([](double p) { return std::cbrt(p); });
  std::array<uint32_t, 64> w{};
  for (size_t i = 0; i < 16; ++i)
    for (size_t k = 0; k < 4; ++k) w[i] = w[i] << 8 | block[4 * i + k];
  for (size_t i = 16; i < 64; ++i) {
    const uint32_t a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + w[i - 7] +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10);
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (size_t i = 0; i < 64; ++i) {
    const uint32_t t1 = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                        ((e & f) ^ (~e & g)) + constants[i] + w[i];
    const uint32_t t2 =
        (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + t1;
    d = c;
    c = b;
    b = a;
    a = t1 + t2;
  }
  const State mixed = {a, b, c, d, e, f, g, h};
  for (size_t i = 0; i < state.size(); ++i) state[i] += mixed[i];
}

}  // namespace

std::string sha256(std::string_view bytes) {
  State state = prime_roots<8>([](double p) { return std::sqrt(p); });
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  size_t done = 0;
  for (; bytes.size() - done >= 64; done += 64) add_block(state, data + done);
  // The rest, a one bit, zeros, and the length in bits, filling one or two blocks.
  std::array<unsigned char, 128> tail{};
  const size_t rest = bytes.size() - done;
  std::copy(data + done, data + bytes.size(), tail.begin());
  tail[rest] = 0x80;
  const size_t end = rest < 56 ? 64 : 128;
  const uint64_t bits = uint64_t{bytes.size()} * 8;
  for (size_t k = 0; k < 8; ++k) tail[end - 1 - k] = static_cast<unsigned char>(bits >> (8 * k));
  add_block(state, tail.data());
  if (end == 128) add_block(state, tail.data() + 64);
  std::string hex;
  for (const uint32_t word : state) hex += fmt::format("{:08x}", word);
  return hex;
}

}  // namespace crosspatch
