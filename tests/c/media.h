/* The profiles and the medium that the programs ask about, and what the answers are. */
#ifndef MEDIA_H
#define MEDIA_H

#include "analytic_media.h"

#define SCALE_HEIGHT 2.0

/* The ray from the base of the layers straight up, and a distance along it. */
#define LENGTH 2.0

static const am_profile constant = { 0, { 0 } };

/* Density 1 + h/2: the column from 0 to t is t + t²/4. */
static const am_profile linear = { 1, { 0, 0, 1, 0, 0.5, 1 } };

/* Density exp(-h/H): the column from 0 to t is H (1 - exp(-t/H)). */
static const am_profile exponential = { 2, { 0, 0, 1, 0, SCALE_HEIGHT } };

/* Uniform fog under an exponential layer, in two channels. */
static const am_profile profiles[2] = { { 0, { 0 } }, { 2, { 0, 0, 1, 0, SCALE_HEIGHT } } };
static const double sigma_t[4] = { 0.1, 0.2, 1, 3 };
static const am_medium medium = { profiles, sigma_t, 2, 2 };

#endif
