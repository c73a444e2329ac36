/* A glass bead falls for a tenth of a second: the public interface from a program of its own. */
#include <math.h>
#include <shiver/shiver.h>
#include <stdio.h>

int main(void)
{
    ShvMaterialDefinition glass = shv_material_default();
    glass.name = "glass";
    glass.density = 2500.0;
    glass.youngs_modulus = 70e9;
    glass.poissons_ratio = 0.22;
    glass.fracture_energy = 8.0;
    glass.cohesive_strength = 40e6;
    ShvObjectDefinition bead = shv_object_default();
    bead.name = "bead";
    bead.material = "glass";
    bead.mesh.kind = SHV_MESH_BALL;
    bead.mesh.radius = 0.01;
    bead.mesh.edge = 0.004;
    ShvSceneDefinition scene = shv_scene_default();
    scene.name = "bead";
    scene.materials = &glass;
    scene.material_count = 1;
    scene.objects = &bead;
    scene.object_count = 1;
    scene.duration = 0.1;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    ShvStatus status = shv_simulation_create(&simulation, &scene, NULL, &error);
    while (status == SHV_OK && !shv_simulation_finished(simulation))
        status = shv_simulation_advance(simulation, &error);
    if (status != SHV_OK) return fprintf(stderr, "%s\n", error.message), 1;
    const double fallen = -shv_simulation_frame(simulation)->fragments[0].position[2];
    printf("shiver %s: fell %.9f m\n", shv_version(), fallen);
    shv_simulation_destroy(simulation);
    return fabs(fallen - 0.5 * 9.81 * 0.01) < 1e-9 ? 0 : 1;
}
