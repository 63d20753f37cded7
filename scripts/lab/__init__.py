"""What benchmarks and experiments share: resumable cells, statistics, maps of drives, hardware."""
