/* SPDX-License-Identifier: MIT
 * bench_peer_nanoflann.cpp - nearest visible points by nanoflann: its tree, and a result set that
 * takes only points above the horizon, so that the search stops as early as it can. */
#include "apps/bench_peers.h"

#include <cmath>
#include <limits>
#include <memory>
#include <nanoflann.hpp>

namespace
{

struct Cloud {
    size_t count;
    const double (*point)[3];

    size_t kdtree_get_point_count() const
    {
        return count;
    }
    double kdtree_get_pt(size_t k, size_t c) const
    {
        return point[k][c];
    }
    template <class Box> bool kdtree_get_bbox(Box &) const
    {
        return false;
    }
};

/* The four nearest that are visible; ties by index, which is why the worst distance is reported a
 * step larger than it is. */
class Visible
{
  public:
    Visible(const Cloud &points, const double *place, const double *normal, double least)
        : cloud(points), x(place), n(normal), cos2(least)
    {
    }

    bool addPoint(double d2, uint32_t index)
    {
        const double *p = cloud.point[index];
        const double c = n[0] * (p[0] - x[0]) + n[1] * (p[1] - x[1]) + n[2] * (p[2] - x[2]);
        if (!(c > 0 && c * c > cos2 * d2) || !before(d2, index, 3))
            return true;
        int at = 3;
        for (; at > 0 && before(d2, index, at - 1); at--) {
            distance[at] = distance[at - 1];
            chosen[at] = chosen[at - 1];
        }
        distance[at] = d2;
        chosen[at] = index;
        if (chosen[3] != none)
            worst = std::nextafter(distance[3], std::numeric_limits<double>::max());
        return true;
    }
    double worstDist() const
    {
        return worst;
    }
    bool full() const
    {
        return chosen[3] != none;
    }
    void write(uint16_t out[4]) const
    {
        for (int k = 0; k < 4; k++)
            out[k] = chosen[k] == none ? UINT16_MAX : static_cast<uint16_t>(chosen[k]);
    }

  private:
    static constexpr uint32_t none = UINT32_MAX;

    bool before(double d2, uint32_t index, int k) const
    {
        return d2 < distance[k] || (d2 == distance[k] && index < chosen[k]);
    }

    const Cloud &cloud;
    const double *x, *n;
    double cos2;
    double worst = std::numeric_limits<double>::max();
    double distance[4] = {worst, worst, worst, worst};
    uint32_t chosen[4] = {none, none, none, none};
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

/* The best of 4, 10 and 32 here. */
constexpr size_t leaf = 10;

} // namespace

struct bench_tree {
    Cloud cloud;
    Tree tree;

    bench_tree(size_t count, const double (*point)[3])
        : cloud{count, point}, tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(leaf))
    {
        tree.buildIndex();
    }
};

bench_tree *bench_tree_create(size_t count, const double (*point)[3])
try {
    return new bench_tree(count, point);
} catch (...) {
    return nullptr;
}

void bench_tree_destroy(bench_tree *tree)
{
    delete tree;
}

void bench_tree_search(const bench_tree *tree, double cos2, size_t count, const float (*x)[3],
                       const float (*n)[3], uint16_t (*out)[4])
{
    const nanoflann::SearchParams params;
    for (size_t k = 0; k < count; k++) {
        const double place[3] = {x[k][0], x[k][1], x[k][2]};
        const double normal[3] = {n[k][0], n[k][1], n[k][2]};
        Visible result(tree->cloud, place, normal, cos2);
        tree->tree.findNeighbors(result, place, params);
        result.write(out[k]);
    }
}
