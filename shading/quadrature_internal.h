/* SPDX-License-Identifier: MIT
 * quadrature_internal.h - Gauss's nodes and weights. */
#ifndef NCR_SHADING_QUADRATURE_INTERNAL_H
#define NCR_SHADING_QUADRATURE_INTERNAL_H

/* Nodes, rising, and weights on [-1,1], exact for polynomials of degree 2 count - 1. */
void ncr_gauss_legendre(int count, double *node, double *weight);

#endif
