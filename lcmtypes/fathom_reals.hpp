// Floating-point numbers of messages, by way of integers as LCM has them on the wire. LCM's own functions write a double
// through a pointer to an integer; inlined, that is undone by an optimiser that trusts that types share no memory.
// guard_lengths.cmake puts these in their place.
#pragma once

#include <lcm/lcm_coretypes.h>

#include <cstdint>
#include <cstring>

namespace fathom_reals {

template <class Real, class Word, int (*kEncode)(void*, int, int, const Word*, int)>
int encode(void* buffer, int offset, int maxlen, const Real* values, int count) {
  static_assert(sizeof(Real) == sizeof(Word));
  for (int i = 0, at = 0; i < count; ++i, at += static_cast<int>(sizeof(Word))) {
    Word word{};
    std::memcpy(&word, values + i, sizeof word);
    if (const int length = kEncode(buffer, offset + at, maxlen - at, &word, 1); length < 0) return length;
  }
  return count * static_cast<int>(sizeof(Word));
}

template <class Real, class Word, int (*kDecode)(const void*, int, int, Word*, int)>
int decode(const void* buffer, int offset, int maxlen, Real* values, int count) {
  static_assert(sizeof(Real) == sizeof(Word));
  for (int i = 0, at = 0; i < count; ++i, at += static_cast<int>(sizeof(Word))) {
    Word word{};
    if (const int length = kDecode(buffer, offset + at, maxlen - at, &word, 1); length < 0) return length;
    std::memcpy(values + i, &word, sizeof word);
  }
  return count * static_cast<int>(sizeof(Word));
}

inline int encode_doubles(void* buffer, int offset, int maxlen, const double* values, int count) {
  return encode<double, std::int64_t, __int64_t_encode_array>(buffer, offset, maxlen, values, count);
}
inline int decode_doubles(const void* buffer, int offset, int maxlen, double* values, int count) {
  return decode<double, std::int64_t, __int64_t_decode_array>(buffer, offset, maxlen, values, count);
}
inline int encode_floats(void* buffer, int offset, int maxlen, const float* values, int count) {
  return encode<float, std::int32_t, __int32_t_encode_array>(buffer, offset, maxlen, values, count);
}
inline int decode_floats(const void* buffer, int offset, int maxlen, float* values, int count) {
  return decode<float, std::int32_t, __int32_t_decode_array>(buffer, offset, maxlen, values, count);
}

}  // namespace fathom_reals
