// expect: version
#version 330

void main() {}
