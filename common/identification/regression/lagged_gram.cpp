#include "common/identification/regression/lagged_gram.hpp"

#include <algorithm>

namespace fathom::identification {

// With d = z_n - z_n-1 and k = 1 - phi, w = d + k z_n-1, so that
//   sum w w' = phi sum d d' + k (sum z_n z_n' - sum z_n-1 z_n-1') + k^2 sum z_n-1 z_n-1',
// and the middle sum is that of the ends alone. Nothing large is subtracted where phi is near one.
namespace {

template <class Matrix>
void mirror(Matrix& m) {
  m.template triangularView<Eigen::StrictlyUpper>() = m.transpose();
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

#if defined(__x86_64__)
// Where the processor has it, sums of products with four lanes and fused multiply-add: this pass is most of the cost of
// a regression, and Debian's compilers may assume but two lanes. Tiles of 4 x 8 sums stay in registers; they are named
// one by one because an array of them goes to memory and back with every row.
using Lanes = double __attribute__((vector_size(32)));
constexpr Eigen::Index kTall = 4, kWide = 8;

__attribute__((target("avx2,fma"))) void gram_in_lanes(const double* rows, Eigen::Index n, Eigen::Index width,
                                                       Eigen::MatrixXd& sum) {
  for (Eigen::Index j = 0; j < width; j += kWide) {
    for (Eigen::Index i = j; i < width; i += kTall) {
      Lanes a0{}, a1{}, b0{}, b1{}, c0{}, c1{}, d0{}, d1{};
      const double* row = rows;
      for (Eigen::Index k = 0; k < n; ++k, row += width) {
        Lanes low, high;
        __builtin_memcpy(&low, row + j, sizeof low);
        __builtin_memcpy(&high, row + j + 4, sizeof high);
        const double a = row[i], b = row[i + 1], c = row[i + 2], d = row[i + 3];
        a0 += a * low, a1 += a * high;
        b0 += b * low, b1 += b * high;
        c0 += c * low, c1 += c * high;
        d0 += d * low, d1 += d * high;
      }
      const Lanes tile[kTall][2] = {{a0, a1}, {b0, b1}, {c0, c1}, {d0, d1}};
      for (Eigen::Index t = 0; t < kTall; ++t) {
        for (Eigen::Index s = 0; s < kWide; ++s) {
          if (i + t < sum.rows() && j + s < sum.cols()) sum(i + t, j + s) = tile[t][s / 4][s % 4];
        }
      }
    }
  }
}
#endif

/// Lower triangle of rows^T rows; the rows' width is that of `sum`, filled up with zeros to a multiple of eight.
void gram(const Eigen::Ref<const RowMajor>& rows, Eigen::MatrixXd& sum) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    gram_in_lanes(rows.data(), rows.rows(), rows.cols(), sum);
    return;
  }
#endif
  sum.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(sum.cols()).transpose());
}

}  // namespace

void LaggedGram::add(const Samples& samples, int block) {
  const Eigen::Index n = samples.rows();
  if (n < 2) return;
  const Eigen::Index parts = std::max<Eigen::Index>(1, (n - 1) / std::max(block, 1));
  constexpr Eigen::Index kPadding = 8;
  const Eigen::Index width = (columns_ + kPadding - 1) / kPadding * kPadding;
  RowMajor packed, difference;  // a block at a time: it stays in the cache
  for (Eigen::Index part = 0; part < parts; ++part) {
    const Eigen::Index from = part * (n - 1) / parts, to = (part + 1) * (n - 1) / parts;  // samples from + 1 .. to
    BlockGram& one = blocks_.emplace_back();
    one.count = static_cast<int>(to - from) + (part == 0 ? 1 : 0);
    one.opens = part == 0;
    one.before = samples.row(from).transpose();
    one.last = samples.row(to).transpose();
    one.steps.setZero(columns_, columns_);
    one.lagged.setZero(columns_, columns_);
    const Eigen::Index length = to - from;
    if (packed.rows() < length + 1) {
      packed.setZero(length + 1, width);
      difference.setZero(length, width);
    }
    packed.topLeftCorner(length + 1, columns_) = samples.middleRows(from, length + 1);
    difference.topRows(length) = packed.middleRows(1, length) - packed.topRows(length);
    gram(difference.topRows(length), one.steps);
    gram(packed.topRows(length), one.lagged);
    mirror(one.steps);
    mirror(one.lagged);
    sum(one);
  }
  ++stretches_;
}

void LaggedGram::add(const LaggedGram& other) {
  if (other.blocks_.empty()) return;
  start();
  blocks_.insert(blocks_.end(), other.blocks_.begin(), other.blocks_.end());
  steps_ += other.steps_;
  lagged_ += other.lagged_;
  ends_ += other.ends_;
  firsts_ += other.firsts_;
  samples_ += other.samples_;
  stretches_ += other.stretches_;
}

LaggedGram LaggedGram::part(std::size_t begin, std::size_t count) const {
  LaggedGram result{columns_};
  for (std::size_t i = begin; i < std::min(begin + count, blocks_.size()); ++i) {
    result.blocks_.push_back(blocks_[i]);
    result.sum(blocks_[i]);
    result.stretches_ += blocks_[i].opens ? 1 : 0;
  }
  return result;
}

void LaggedGram::start() {
  if (steps_.size() > 0) return;
  steps_.setZero(columns_, columns_);
  lagged_ = ends_ = firsts_ = steps_;
}

void LaggedGram::sum(const BlockGram& block) {
  start();
  steps_ += block.steps;
  lagged_ += block.lagged;
  ends_ += block.last * block.last.transpose() - block.before * block.before.transpose();
  if (block.opens) firsts_ += block.before * block.before.transpose();
  samples_ += block.count;
}

Eigen::MatrixXd LaggedGram::whitened(double phi) const {
  if (steps_.size() == 0) return Eigen::MatrixXd::Zero(columns_, columns_);
  const double k = 1.0 - phi;
  return phi * steps_ + k * ends_ + (k * k) * lagged_ + ((1.0 - phi * phi)) * firsts_;
}

Eigen::MatrixXd LaggedGram::whitened(double phi, const BlockGram& block) const {
  const double k = 1.0 - phi;
  Eigen::MatrixXd result = phi * block.steps + (k * k) * block.lagged;
  result += k * (block.last * block.last.transpose() - block.before * block.before.transpose());
  if (block.opens) result += (1.0 - phi * phi) * (block.before * block.before.transpose());
  return result;
}

LaggedGram::Residual LaggedGram::residual(const Eigen::VectorXd& c) const {
  Residual result;
  if (steps_.size() == 0) return result;
  const double steps = c.dot(steps_ * c);
  result.lagged = c.dot(lagged_ * c);
  result.square = result.lagged + c.dot(ends_ * c);
  result.cross = 0.5 * (result.square + result.lagged - steps);
  result.first = c.dot(firsts_ * c);
  return result;
}

}  // namespace fathom::identification
