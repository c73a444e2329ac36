// Writes the mesh of the npm package "bunny" as OBJ: node bunny.js FOLDER_OF_THE_PACKAGE > bunny.obj
const { positions, cells } = require(require('path').resolve(process.argv[2]));
const line = (kind) => (numbers) => kind + ' ' + numbers.join(' ') + '\n';
process.stdout.write(
  '# The Stanford Bunny (Stanford Computer Graphics Laboratory), from the npm package bunny\n' +
    positions.map(line('v')).join('') +
    cells.map((corners) => line('f')(corners.map((corner) => corner + 1))).join('')
);
