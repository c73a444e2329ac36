// A turned cup: height 90 mm, diameter 80 mm, wall 4 mm, bottom 5 mm. `gmsh -3 mug.geo -o mug.msh` made mug.msh.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 0.09, 0.04};
Cylinder(2) = {0, 0, 0.005, 0, 0, 0.09, 0.036};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Mesh.MeshSizeMin = 0.004;
Mesh.MeshSizeMax = 0.004;
Mesh.Optimize = 1;
Mesh.OptimizeNetgen = 1;
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
