"""What experiments share: resumable cells, statistics, acceptance figures, hardware, arguments."""
