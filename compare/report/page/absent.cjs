/* Stands for three and Observable Plot in a page that is built without npm. */
module.exports = { absent: true };
