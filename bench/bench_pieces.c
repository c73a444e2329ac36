/* Speed of convex pieces: bench_pieces [MESH.msh]. A glass ball of radius 0.1 m, meshed with about 45,000 tets or read from a
   gmsh file, is cut by nearest seed into 10, 100 and 5,000 pieces. One line of CSV each: fragments, seconds for all of them on
   one core (the best of several rounds counts: other work on the machine only ever slows it down), hulls a fragment, most
   vertices of a hull, and, in % of the ball, space in hulls that the fragment does not own and its tets in no hull. */
#include <math.h>
#include <stdio.h>

#include "base/text.h"
#include "base/timer.h"
#include "broken_ball.h"
#include "convex/convex_pieces.h"

enum { ROUNDS = 5 };

typedef struct Total {
    int32_t fragments, hulls, most_vertices;
    double outside, missing, volume;
} Total;

static ShvStatus make_all(const BrokenBall *ball, Total *total, ShvError *error)
{
    *total = (Total){0};
    for (int32_t f = 0; f < ball->fragments.count; f++) {
        if (ball->fragments.items[f].mode == SHV_MODE_DEAD) continue;
        ShvConvexPieces pieces;
        SHV_TRY(shv_convex_pieces_make(&pieces, &ball->fragments, &ball->model, &ball->state, f, error));
        total->fragments++;
        total->hulls += pieces.count;
        total->outside += pieces.outside;
        total->missing += pieces.missing;
        total->volume += ball->fragments.items[f].volume;
        for (int32_t p = 0; p < pieces.count; p++) {
            const int32_t vertices = pieces.vertex_begin[p + 1] - pieces.vertex_begin[p];
            if (vertices > total->most_vertices) total->most_vertices = vertices;
        }
        shv_convex_pieces_release(&pieces);
    }
    return SHV_OK;
}

static ShvStatus measure(const char *file, int32_t seeds, ShvError *error)
{
    BrokenBall ball;
    Total total = {0};
    double best = (double)INFINITY;
    ShvStatus status = broken_ball_make(&ball, file, 0.01, seeds, error);
    for (int round = 0; round < ROUNDS && status == SHV_OK; round++) {
        const double start = shv_now();
        status = make_all(&ball, &total, error);
        best = fmin(best, shv_now() - start);
    }
    if (status == SHV_OK)
        shv_print(stdout, "%d,%d,%d,%.4f,%.2f,%d,%.2f,%.2f\n", (int)ball.state.element_count, (int)seeds,
                  (int)total.fragments, best, (double)total.hulls / total.fragments, (int)total.most_vertices,
                  100.0 * total.outside / total.volume, 100.0 * total.missing / total.volume);
    broken_ball_release(&ball);
    return status;
}

int main(int argc, char **argv)
{
    static const int32_t seeds[] = {10, 100, 5000};
    ShvError error;
    puts("tets,seeds,fragments,seconds,hulls_per_fragment,most_vertices,outside_percent,missing_percent");
    for (int i = 0; i < 3; i++)
        if (measure(argc > 1 ? argv[1] : NULL, seeds[i], &error) != SHV_OK) {
            fprintf(stderr, "%s\n", error.message);
            return 1;
        }
    return 0;
}
