/* SPDX-License-Identifier: MIT
 * bench_peer_opensubdiv.cpp - translation only. */
#include "apps/bench_peers.h"

#include <memory>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <vector>

using namespace OpenSubdiv;

namespace
{

template <typename Real> struct Ready {
    Bfr::Surface<Real> surface;
    std::vector<Real> points;

    void prepare(const Bfr::RefinerSurfaceFactory<> &factory, const double grid[16][3])
    {
        std::vector<Real> mesh;
        for (int k = 0; k < 48; k++)
            mesh.push_back(static_cast<Real>(grid[k / 3][k % 3]));
        factory.InitVertexSurface(4, &surface); /* the middle one of nine faces */
        points.resize(3 * static_cast<size_t>(surface.GetNumPatchPoints()));
        surface.PreparePatchPoints(mesh.data(), 3, points.data(), 3);
    }

    void eval(size_t count, const Real *u, const Real *v, Real (*out)[6][3]) const
    {
        for (size_t k = 0; k < count; k++) {
            const Real uv[2] = {u[k], v[k]};
            Real(*o)[3] = out[k];
            surface.Evaluate(uv, points.data(), 3, o[0], o[1], o[2], o[3], o[4], o[5]);
        }
    }
};

std::unique_ptr<Far::TopologyRefiner> make_grid()
{
    std::vector<int> sizes(9, 4), corners;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++)
            for (int at : {4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4})
                corners.push_back(at);
    Far::TopologyDescriptor desc;
    desc.numVertices = 16;
    desc.numFaces = 9;
    desc.numVertsPerFace = sizes.data();
    desc.vertIndicesPerFace = corners.data();
    using Maker = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    return std::unique_ptr<Far::TopologyRefiner>(
        Maker::Create(desc, Maker::Options(Sdc::SCHEME_CATMARK)));
}

} // namespace

struct bench_bfr {
    std::unique_ptr<Far::TopologyRefiner> topology;
    std::unique_ptr<Bfr::RefinerSurfaceFactory<>> factory;
    Ready<float> single;
    Ready<double> twice;
};

bench_bfr *bench_bfr_create(const double grid[16][3])
try {
    auto bfr = std::make_unique<bench_bfr>();
    bfr->topology = make_grid();
    if (!bfr->topology)
        return nullptr;
    bfr->factory = std::make_unique<Bfr::RefinerSurfaceFactory<>>(*bfr->topology);
    bfr->single.prepare(*bfr->factory, grid);
    bfr->twice.prepare(*bfr->factory, grid);
    return bfr.release();
} catch (...) {
    return nullptr;
}

void bench_bfr_destroy(bench_bfr *bfr)
{
    delete bfr;
}

void bench_bfr_eval_f(const bench_bfr *bfr, size_t count, const float *u, const float *v,
                      float (*out)[6][3])
{
    bfr->single.eval(count, u, v, out);
}

void bench_bfr_eval_d(const bench_bfr *bfr, size_t count, const double *u, const double *v,
                      double (*out)[6][3])
{
    bfr->twice.eval(count, u, v, out);
}
