// The command line: `lodestone run | sign | inspect | compare …`.
int main() { return 0; }
