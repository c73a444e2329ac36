/* A box that bounces on a floor, with its closed form: for tests of studies. */
#ifndef SHV_TESTS_BOUNCE_H
#define SHV_TESTS_BOUNCE_H

static const char bounce_scene[] =
    "shiver: 1\nname: bounce\n"
    "materials: {m: {density: 1000, youngs_modulus: 1e6, poissons_ratio: 0.3, breakable: false}}\n"
    "objects: {box: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: m, position: [0, 0, 0.25]}}\n"
    "obstacles: {floor: {plane: {normal: [0, 0, 1]}, restitution: 0.5}}\n"
    "duration: 0.3\noutput: {rate: 100}\nreference: {law: bounce, body: box, on: floor}\nthreads: 1\n";

#endif
