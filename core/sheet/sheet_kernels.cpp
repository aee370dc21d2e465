#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sheet/sheet_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <cstddef>

#include "core/sheet/sheet_kernels.h"

// The scalar reference is in tests/core/sheet/sheet_solver_test.cpp.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, kSheetPad>;
using Lane = hn::Vec<Tag>;

struct Lanes {
  Lane x, y, z;
};

Lanes load(const SheetField& from, std::size_t n) {
  const Tag d;
  return {hn::LoadU(d, from.x + n), hn::LoadU(d, from.y + n), hn::LoadU(d, from.z + n)};
}
void store(const Lanes& v, const SheetField& to, std::size_t n) {
  const Tag d;
  hn::StoreU(v.x, d, to.x + n);
  hn::StoreU(v.y, d, to.y + n);
  hn::StoreU(v.z, d, to.z + n);
}
Lanes minus(const Lanes& a, const Lanes& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
Lanes plus(const Lanes& a, const Lanes& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
Lanes scaled(Lane by, const Lanes& v) { return {hn::Mul(by, v.x), hn::Mul(by, v.y), hn::Mul(by, v.z)}; }

Lane sum_of(Lane a, Lane b, Lane c) { return hn::Add(hn::Add(a, b), c); }
Lane product_of(const Lanes& a, const Lanes& b) { return sum_of(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)); }

Lanes times_block(const SheetBlocks& m, std::size_t n, const Lanes& v) {
  const Tag d;
  const auto at = [&](const double* from) { return hn::LoadU(d, from + n); };
  const Lane xx = at(m.xx), xy = at(m.xy), xz = at(m.xz), yy = at(m.yy), yz = at(m.yz), zz = at(m.zz);
  return {sum_of(hn::Mul(xx, v.x), hn::Mul(xy, v.y), hn::Mul(xz, v.z)), sum_of(hn::Mul(xy, v.x), hn::Mul(yy, v.y), hn::Mul(yz, v.z)),
          sum_of(hn::Mul(xz, v.x), hn::Mul(yz, v.y), hn::Mul(zz, v.z))};
}

/// Adds the first `count` lanes, one after another.
void add_lanes(Lane values, std::size_t count, double& sum) {
  const Tag d;
  HWY_ALIGN double one[kSheetPad];
  hn::Store(values, d, one);
  for (std::size_t k = 0; k < HWY_MIN(count, hn::Lanes(d)); ++k) sum += one[k];
}

std::size_t beside(std::size_t n, std::int32_t by) { return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(n) + by); }

/// Lanes beyond a span get values of no meaning, which the next spans replace.
template <class F>
void for_each_vector(const SheetJob& job, const F& f) {
  const Tag d;
  for (const SheetSpan& span : job.spans)
    for (std::size_t n = 0; n < span.count; n += hn::Lanes(d)) f(span, span.first + n, span.count - n);
}

void FindPulls(const SheetJob& job, const SheetField& in) {
  for_each_vector(job, [&](const SheetSpan& span, std::size_t n, std::size_t) {
    const Lanes at = load(in, n);
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes way = minus(at, load(in, beside(n, span.onward[k])));
      store(times_block(job.edges[k], n, way), job.pulls[k], n);
    }
  });
}

/// Bending at the nodes whose row has an order of its own.
void BendOdd(const SheetJob& job, const SheetField& in) {
  for (const std::uint32_t n : job.odd) {
    double x = 0.0, y = 0.0, z = 0.0;
    for (std::uint32_t k = job.first[n]; k < job.first[n + 1]; ++k) {
      x += job.value[k] * in.x[job.column[k]];
      y += job.value[k] * in.y[job.column[k]];
      z += job.value[k] * in.z[job.column[k]];
    }
    job.bent.x[n] = x;
    job.bent.y[n] = y;
    job.bent.z[n] = z;
  }
}

/// out = A in. @returns in . out.
double Times(const SheetJob& job, const SheetField& in, const SheetField& out) {
  const Tag d;
  const hn::Rebind<std::uint64_t, Tag> bits;
  FindPulls(job, in);
  BendOdd(job, in);
  double product = 0.0;
  for_each_vector(job, [&](const SheetSpan& span, std::size_t n, std::size_t count) {
    const Lanes v = load(in, n);
    // A sum from 0 on is never -0: the terms of 0 that a row lacks, and the odd ones, leave its bits.
    Lanes bent{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t k = 0; k < kBendTerms; ++k)
      bent = plus(bent, scaled(hn::LoadU(d, job.bend[k] + n), load(in, beside(n, span.bend[k]))));
    bent = plus(bent, load(job.bent, n));
    Lanes sum = plus(scaled(hn::LoadU(d, job.all + n), v), bent);
    sum.z = hn::Add(sum.z, hn::Mul(hn::LoadU(d, job.up + n), v.z));
    constexpr std::size_t kBackEdges[] = {1, 2, 0};
    for (std::size_t k = 0; k < 3; ++k) sum = minus(sum, load(job.pulls[kBackEdges[k]], beside(n, span.back[k])));
    Lanes own{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (const SheetField& pull : job.pulls) own = plus(own, load(pull, n));
    sum = plus(sum, own);
    const Lane kept = hn::BitCast(d, hn::LoadU(bits, job.free + n));
    sum = {hn::And(sum.x, kept), hn::And(sum.y, kept), hn::And(sum.z, kept)};
    add_lanes(product_of(v, sum), count, product);
    store(sum, out, n);
  });
  return product;
}

/// conditioned = D rest. @returns rest . conditioned.
template <class F>
double Precondition(const SheetJob& job, const F& before) {
  const Tag d;
  double sum = 0.0;
  for (std::size_t n = 0; n < job.nodes; n += hn::Lanes(d)) {
    const Lanes rest = before(n), conditioned = times_block(job.diagonal, n, rest);
    store(conditioned, job.conditioned, n);
    add_lanes(product_of(rest, conditioned), job.nodes - n, sum);
  }
  return sum;
}

int ConjugateGradients(const SheetJob& job) {
  const Tag d;
  Times(job, job.out, job.product);
  double start = 0.0;
  for (std::size_t n = 0; n < job.nodes; n += hn::Lanes(d)) {
    const Lanes right = load(job.right, n);
    add_lanes(product_of(right, times_block(job.diagonal, n, right)), job.nodes - n, start);
  }
  double size = Precondition(job, [&](std::size_t n) {
    const Lanes rest = minus(load(job.right, n), load(job.product, n));
    store(rest, job.rest, n);
    return rest;
  });
  for (std::size_t n = 0; n < job.nodes; n += hn::Lanes(d)) store(load(job.conditioned, n), job.search, n);
  const double enough = start * job.tolerance * job.tolerance;
  int steps = 0;
  for (; steps < job.most && size > enough && size > 0.0; ++steps) {
    const double curvature = Times(job, job.search, job.product);
    if (!(curvature > 0.0)) break;
    const Lane way = hn::Set(d, size / curvature);
    const double next = Precondition(job, [&](std::size_t n) {
      store(plus(load(job.out, n), scaled(way, load(job.search, n))), job.out, n);
      const Lanes rest = minus(load(job.rest, n), scaled(way, load(job.product, n)));
      store(rest, job.rest, n);
      return rest;
    });
    const Lane turn = hn::Set(d, next / size);
    for (std::size_t n = 0; n < job.nodes; n += hn::Lanes(d))
      store(plus(load(job.conditioned, n), scaled(turn, load(job.search, n))), job.search, n);
    size = next;
  }
  return steps;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(ConjugateGradients);

int conjugate_gradients(const SheetJob& job) noexcept { return HWY_DYNAMIC_DISPATCH(ConjugateGradients)(job); }

}  // namespace burrhole
#endif
