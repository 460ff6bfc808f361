/* A ball that is pressed into the gel. */
#ifndef OFC_BALL_H
#define OFC_BALL_H

#include "gel.h"

static const double radius = 60;

/* Where it is pressed in. */
static const double places[4][2] = {{60, 50}, {100, 50}, {60, 75}, {100, 70}};

/* A spherical cap in a skirt. */
static void cap(double u, double v, double *p, double *q)
{
    const double rim = 24, skirt = 10, steepest = rim / sqrt(radius * radius - rim * rim), r = sqrt(u * u + v * v);
    const double slope = r < rim            ? r / sqrt(radius * radius - r * r)
                         : r < rim + skirt ? steepest * (rim + skirt - r) / skirt
                                           : 0;
    *p = r > 0 ? -u / r * slope : 0;
    *q = r > 0 ? -v / r * slope : 0;
}

#endif
