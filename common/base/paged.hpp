// A sequence of numbers that only grows, of which a long one lies on disk: a table of ten million rows takes the memory
// of one of half a million.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace fathom {

/// A file without a name, in $TMPDIR or /var/tmp (which no system keeps in memory), that is gone with its owner.
class PageFile {
 public:
  /// InputError with what to do about it.
  PageFile();
  ~PageFile();
  PageFile(const PageFile&) = delete;
  PageFile& operator=(const PageFile&) = delete;
  /// InputError when the disk is full.
  void write(std::uint64_t at, const void* from, std::size_t size);
  void read(std::uint64_t at, void* to, std::size_t size) const;

 private:
  int descriptor_{-1};
};

/// Up to kInMemory values are a plain vector; more go to a file page by page, and two pages are kept that were looked
/// at last: made for passes from the first to the last, with a look at the one before. Not for two threads at once.
template <class Value>
class Paged {
  static_assert(std::is_trivially_copyable_v<Value>);

 public:
  static constexpr std::size_t kInMemory = std::size_t{1} << 19U;  ///< values: of an hour at 100 Hz all
  static constexpr std::size_t kPage = std::size_t{1} << 13U;      ///< values

  class Iterator {
   public:
    using iterator_concept = std::random_access_iterator_tag;
    using iterator_category = std::input_iterator_tag;
    using value_type = Value;
    using difference_type = std::ptrdiff_t;
    using reference = Value;
    using pointer = void;
    Iterator() = default;
    Iterator(const Paged& all, std::size_t at) : all_{&all}, at_{at} {}
    Value operator*() const { return (*all_)[at_]; }
    Value operator[](difference_type n) const { return *(*this + n); }
    Iterator& operator++() { return *this += 1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator& operator--() { return *this -= 1; }
    Iterator operator--(int) { return std::exchange(*this, *this - 1); }
    Iterator& operator+=(difference_type n) {
      at_ = static_cast<std::size_t>(static_cast<difference_type>(at_) + n);
      return *this;
    }
    Iterator& operator-=(difference_type n) { return *this += -n; }
    friend Iterator operator+(Iterator a, difference_type n) { return a += n; }
    friend Iterator operator+(difference_type n, Iterator a) { return a += n; }
    friend Iterator operator-(Iterator a, difference_type n) { return a -= n; }
    friend difference_type operator-(const Iterator& a, const Iterator& b) {
      return static_cast<difference_type>(a.at_) - static_cast<difference_type>(b.at_);
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    auto operator<=>(const Iterator& other) const { return at_ <=> other.at_; }

   private:
    const Paged* all_{};
    std::size_t at_{};
  };

  Paged() = default;
  Paged(Paged&&) noexcept = default;
  Paged& operator=(Paged&&) noexcept = default;

  void push_back(Value value) {
    memory_.push_back(value);
    ++size_;
    if (file_ == nullptr ? size_ > kInMemory : memory_.size() == kPage) spill();
  }
  void reserve(std::size_t count) { memory_.reserve(std::min(count, kInMemory + 1)); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Value operator[](std::size_t i) const {
    if (i >= spilled_) return memory_[i - spilled_];
    const std::size_t page = i / kPage;
    const Kept* kept = page == kept_[0].page ? &kept_[0] : page == kept_[1].page ? &kept_[1] : fetch(page);
    return kept->values[i % kPage];
  }
  [[nodiscard]] Value front() const { return (*this)[0]; }
  [[nodiscard]] Value back() const { return (*this)[size_ - 1]; }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }
  bool operator==(const std::vector<Value>& other) const {
    return std::equal(begin(), end(), other.begin(), other.end());
  }

  /// use(value&) for every one.
  template <class Use>
  void change(const Use& use) {
    std::vector<Value> page(kPage);
    for (std::size_t i = 0; i < spilled_; i += kPage) {
      file_->read(i * sizeof(Value), page.data(), kPage * sizeof(Value));
      std::ranges::for_each(page, use);
      file_->write(i * sizeof(Value), page.data(), kPage * sizeof(Value));
    }
    for (Kept& each : kept_) each.page = kNone;
    std::ranges::for_each(memory_, use);
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  struct Kept {
    std::size_t page{kNone};
    std::vector<Value> values;
  };

  /// Whole pages go to the file; what is left of the last one stays.
  void spill() {
    if (file_ == nullptr) file_ = std::make_unique<PageFile>();
    const std::size_t whole = memory_.size() / kPage * kPage;
    file_->write(spilled_ * sizeof(Value), memory_.data(), whole * sizeof(Value));
    std::vector<Value> rest(memory_.begin() + static_cast<std::ptrdiff_t>(whole), memory_.end());
    rest.reserve(kPage);
    memory_ = std::move(rest);
    spilled_ += whole;
  }
  const Kept* fetch(std::size_t page) const {
    std::swap(kept_[0], kept_[1]);
    kept_[0].page = page;
    kept_[0].values.resize(kPage);
    file_->read(page * kPage * sizeof(Value), kept_[0].values.data(), kPage * sizeof(Value));
    return &kept_[0];
  }

  std::size_t size_{}, spilled_{};
  std::vector<Value> memory_;  ///< those behind the spilled ones
  std::unique_ptr<PageFile> file_;
  mutable std::array<Kept, 2> kept_;
};

}  // namespace fathom
